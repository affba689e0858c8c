#pragma once

#include "common/config/experiment.h"

namespace roundabout::config {

/// How old the newest depth picture in the map that a vehicle's planner has may become while all
/// goes well but for one picture that is lost: pictures come, wait until they count, go into the
/// map with a sweep, and the map goes out. s. Precondition: the vehicle has a lidar.
double oldestDepthsS(const Vehicle& vehicle, const Camera& camera, const Perception& perception);

}  // namespace roundabout::config
