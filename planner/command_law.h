#pragma once

#include <Eigen/Core>

#include "common/config/experiment.h"
#include "common/core/agent.h"
#include "planner/policy.h"

namespace roundabout::planner {

/// What the vehicle's velocity controller gets.
struct PlanarCommand {
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double heading_world_rad = 0.0;
  double heading_rate_radps = 0.0;
};

/// From a policy's decision to a velocity (paper, section "Multiple Multirotors"): the chosen speed
/// in the direction of the chosen heading; within planner.slow_down_distance_m of the goal both the
/// speed and the change of heading shrink linearly with the distance. The change of heading shrinks
/// only for policies that choose from an action table, whose coarse turns would make the vehicle
/// wag; a velocity from a continuous policy (ORCA) would lose its meaning.
PlanarCommand commandFrom(const Decision& decision, const core::EgoAgent& ego,
                          const config::Planner& settings);

/// Near enough to the goal for position control (paper: 0.3 m).
bool holdsPosition(const core::EgoAgent& ego, const config::Planner& settings);

}  // namespace roundabout::planner
