#pragma once

#include "common/config/checks.h"
#include "common/config/experiment.h"

namespace roundabout::config {

/// Turns obstacles round whose corners were written clockwise.
void orientObstacles(Experiment& experiment);

/// Refuses obstacles without a name of their own, that are no simple polygons, or that reach out of
/// the room, and starting places too close to one (obstacleSpacingM).
void checkObstacles(const Experiment& experiment, const Refuse& refuse);

}  // namespace roundabout::config
