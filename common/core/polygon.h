#pragma once

#include "common/core/agent.h"

namespace roundabout::core {

/// Of the plane; corners counter-clockwise: positive. m².
double signedArea(const Polygon& polygon);

/// At least three corners, and no two sides touch but neighbours in their common corner.
bool isSimple(const Polygon& polygon);

/// A side turns left or goes on straight at every corner, as those of counter-clockwise convex
/// polygons do.
bool isConvex(const Polygon& polygon);

/// From a place to the nearest point of a simple polygon; negative inside. m.
double distanceTo(const Polygon& polygon, const Eigen::Vector2d& place_m);

}  // namespace roundabout::core
