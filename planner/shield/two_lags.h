#pragma once

#include <span>

#include "planner/shield/motion.h"

namespace roundabout::planner::shield {

/// With an inner lag, and no need to turn: multirotors.
bool hasTwoLags(const MotionBounds& bounds);

/// predict() for as many vehicles with two lags as there are lanes, at most.
void predictTwoLags(std::span<const Forecast> forecasts, std::span<Path> paths);

}  // namespace roundabout::planner::shield
