#pragma once

#include "common/config/experiment.h"

namespace roundabout::config {

/// Smallest horizontal distance between the centres of any two vehicles' goals or starting places:
/// the largest two assumed radii and safety.goal_margin_m. m.
double goalSpacingM(const Experiment& experiment);

/// Smallest distance of a vehicle's goal or starting place from an obstacle: the largest assumed
/// radius and safety.goal_margin_m. m.
double obstacleSpacingM(const Experiment& experiment);

/// The largest body_radius_m. m.
double largestBodyRadiusM(const Experiment& experiment);

}  // namespace roundabout::config
