#pragma once

#include "common/config/experiment.h"
#include "sim/pedestrians/steering.h"

namespace roundabout::sim {

/// What pedestrians.policy names: social_force, or any policy of the planner's table. A person that
/// walks by a policy sees vehicles as it sees people, if it minds them by more than half.
/// Throws core::StartupError as planner::makePolicy().
SteeringFactory steeringFor(const config::Experiment& experiment);

}  // namespace roundabout::sim
