#include "planner/policies/drl_maca/drl_maca.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "common/core/angles.h"
#include "planner/policies/drl_maca/weights.h"

namespace roundabout::planner {

using Eigen::Vector2d;

DrlMaca::DrlMaca(std::shared_ptr<const DrlMacaWeights> weights, bool with_value)
    : network_(std::move(weights)), with_value_(with_value) {}

Decision DrlMaca::decide(const core::EgoAgent& ego, const core::Surroundings& around) {
  const DrlMacaNetwork::OwnInputs own = ownInputs(ego);
  last_heading_rad_ = ego.heading_world_rad;
  Decision decision;
  if (!stack_.push(around.scan)) {
    return decision;
  }
  const DrlMacaNetwork::Output output = network_.evaluate(stack_.scans(), own, with_value_);
  // Inputs beyond all reason overflow; the caller must not fly what comes out.
  const bool sound = std::isfinite(output.linear_mps) && std::isfinite(output.angular_radps);
  decision.speed_mps = sound ? std::min(output.linear_mps, ego.preferred_speed_mps)
                             : std::numeric_limits<double>::quiet_NaN();
  decision.heading_change_rad = output.angular_radps * kTimeStepS;
  decision.value = output.value;
  return decision;
}

/// The goal in the frame of the body, then how fast it moves forward and turns.
DrlMacaNetwork::OwnInputs DrlMaca::ownInputs(const core::EgoAgent& ego) const {
  const Eigen::Rotation2Dd to_body(-ego.heading_world_rad);
  const Vector2d goal_m = to_body * (ego.goal_world_m - ego.position_world_m);
  const double forward_mps = (to_body * ego.velocity_world_mps).x();
  const double turned_rad =
      last_heading_rad_ ? core::wrapToPi(ego.heading_world_rad - *last_heading_rad_) : 0.0;
  const auto single = [](double value) { return static_cast<float>(value); };
  return {single(goal_m.x()), single(goal_m.y()), single(forward_mps),
          single(turned_rad / kTimeStepS)};
}

std::unique_ptr<Policy> DrlMaca::twin() const {
  return std::make_unique<DrlMaca>(network_.weights(), with_value_);
}

void DrlMaca::reset() {
  stack_.clear();
  last_heading_rad_.reset();
}

std::unique_ptr<Policy> makeDrlMaca(const PolicyOptions& options) {
  return std::make_unique<DrlMaca>(readDrlMacaWeights(options.weights), options.with_value);
}

}  // namespace roundabout::planner
