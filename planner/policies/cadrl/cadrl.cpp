#include "planner/policies/cadrl/cadrl.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "common/core/angles.h"
#include "planner/policies/cadrl/weights.h"

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;

Decision towards(double heading_world_rad, double speed_mps, const core::EgoAgent& ego) {
  Decision decision;
  decision.speed_mps = std::min(speed_mps, ego.preferred_speed_mps);
  decision.heading_change_rad = core::wrapToPi(heading_world_rad - ego.heading_world_rad);
  return decision;
}

}  // namespace

Cadrl::Cadrl(std::shared_ptr<const CadrlWeights> weights) : look_ahead_(std::move(weights)) {
  nearest_.reserve(kCadrlOthers);
}

Decision Cadrl::decide(const core::EgoAgent& ego, const core::Surroundings& around) {
  if (around.others.empty()) {
    remembered_.clear();
    const Vector2d to_goal = ego.goal_world_m - ego.position_world_m;
    return to_goal.isZero()
               ? Decision{}
               : towards(std::atan2(to_goal.y(), to_goal.x()), ego.preferred_speed_mps, ego);
  }
  collectNearest(ego, around.others);
  remember(around.others);
  const LookAhead::Choice choice = look_ahead_.choose(ego, nearest_);
  Decision decision = towards(choice.candidate.heading_world_rad, choice.candidate.speed_mps, ego);
  decision.value = choice.value;
  decision.neighbours_used = static_cast<int>(nearest_.size());
  return decision;
}

/// By gap rounded to the centimetre, farthest first; then by position, right of the way to the
/// goal first.
void Cadrl::collectNearest(const core::EgoAgent& ego, std::span<const core::OtherAgent> others) {
  const Vector2d to_goal = ego.goal_world_m - ego.position_world_m;
  const Vector2d orthogonal = Vector2d(-to_goal.y(), to_goal.x()).stableNormalized();
  neighbours_.clear();
  for (const core::OtherAgent& other : others) {
    const Vector2d offset = other.position_world_m - ego.position_world_m;
    const double gap_m = offset.norm() - ego.radius_m - other.radius_m;
    neighbours_.push_back({std::nearbyint(100.0 * gap_m), offset.dot(orthogonal), &other});
  }
  // The last keys are there so that the order in which others are given changes nothing.
  const auto key = [](const Neighbour& each) {
    return std::tuple(each.gap_cm, -each.orthogonal_m, each.agent->position_world_m.x(),
                      each.agent->position_world_m.y(), each.agent->velocity_world_mps.x(),
                      each.agent->velocity_world_mps.y(), each.agent->radius_m, each.agent->id);
  };
  const std::size_t count = std::min<std::size_t>(neighbours_.size(), kCadrlOthers);
  const auto end = neighbours_.begin() + static_cast<std::ptrdiff_t>(count);
  std::partial_sort(
      neighbours_.begin(), end, neighbours_.end(),
      [&](const Neighbour& left, const Neighbour& right) { return key(left) < key(right); });
  nearest_.clear();
  for (auto each = end; each != neighbours_.begin();) {
    --each;
    nearest_.push_back(*each->agent);
    nearest_.back().velocity_world_mps = meanVelocity(*each->agent);
  }
}

Vector2d Cadrl::meanVelocity(const core::OtherAgent& other) const {
  const auto before =
      std::find_if(remembered_.begin(), remembered_.end(), [&other](const Remembered& each) {
        return each.id == other.id && other.id != core::OtherAgent::kNobody;
      });
  return before == remembered_.end()
             ? other.velocity_world_mps
             : Vector2d((before->velocity_world_mps + other.velocity_world_mps) / 2.0);
}

void Cadrl::remember(std::span<const core::OtherAgent> others) {
  remembered_.clear();
  for (const core::OtherAgent& other : others) {
    remembered_.push_back({other.id, other.velocity_world_mps});
  }
}

std::unique_ptr<Policy> Cadrl::twin() const {
  return std::make_unique<Cadrl>(look_ahead_.weights());
}

std::unique_ptr<Policy> makeCadrl(const PolicyOptions& options) {
  return std::make_unique<Cadrl>(readCadrlWeights(options.weights));
}

}  // namespace roundabout::planner
