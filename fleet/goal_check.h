#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/config/experiment.h"

namespace roundabout::fleet {

/// The place nearest to this one to which a planner flies its vehicle: inside the room, less the
/// body radius. For goals that are measured places, which may lie at a wall or beyond it.
Eigen::Vector3d nearestGoal(const config::Experiment& experiment, std::size_t vehicle,
                            const Eigen::Vector3d& place_m);

/// Why nobody may be sent to these points, or nothing: more points than vehicles, not a number,
/// outside the room, closer to an obstacle than config::obstacleSpacingM(), or two closer
/// (horizontally) than config::goalSpacingM(). Names the goals, from 1, and the numbers.
std::optional<std::string> refuseGoals(const config::Experiment& experiment,
                                       const std::vector<Eigen::Vector3d>& points_m);

}  // namespace roundabout::fleet
