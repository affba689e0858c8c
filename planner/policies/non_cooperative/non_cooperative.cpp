#include "planner/policies/non_cooperative/non_cooperative.h"

#include <cmath>

#include "common/core/angles.h"

namespace roundabout::planner {

namespace {

class NonCooperative final : public Policy {
 public:
  Decision decide(const core::EgoAgent& ego, const core::Surroundings&) override {
    Decision decision;
    const Eigen::Vector2d to_goal = ego.goal_world_m - ego.position_world_m;
    if (!to_goal.isZero(0.0)) {
      decision.speed_mps = ego.preferred_speed_mps;
      decision.heading_change_rad =
          core::wrapToPi(std::atan2(to_goal.y(), to_goal.x()) - ego.heading_world_rad);
    }
    return decision;
  }

  std::unique_ptr<Policy> twin() const override { return std::make_unique<NonCooperative>(); }

  std::string_view name() const override { return "non_cooperative"; }
};

}  // namespace

std::unique_ptr<Policy> makeNonCooperative(const PolicyOptions&) {
  return std::make_unique<NonCooperative>();
}

}  // namespace roundabout::planner
