#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/config/experiment.h"

namespace roundabout::fleet {

/// Smallest distance between the centres of any two vehicles' goals: the largest two assumed radii
/// and safety.goal_margin_m. m.
double goalSpacingM(const config::Experiment& experiment);

/// Why nobody may be sent to these points, or nothing: more points than vehicles, not a number,
/// outside the room, or two closer (horizontally) than goalSpacingM(). Names the goals, from 1, and
/// the numbers.
std::optional<std::string> refuseGoals(const config::Experiment& experiment,
                                       const std::vector<Eigen::Vector3d>& points_m);

}  // namespace roundabout::fleet
