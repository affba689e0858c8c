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

/// The smallest convex polygon that holds all points: counter-clockwise, without points on its
/// sides. At least three that are not in a line.
Polygon convexHull(std::vector<Eigen::Vector2d> points);

/// Whether a place lies inside a simple polygon. Either is said of its outline.
bool contains(const Polygon& polygon, const Eigen::Vector2d& place_m);

/// The point of a polygon's outline that is nearest to a place; of equally near ones the first.
Eigen::Vector2d nearestOnOutline(const Polygon& polygon, const Eigen::Vector2d& place_m);

/// From a place to the nearest point of a simple polygon; negative inside. m.
double distanceTo(const Polygon& polygon, const Eigen::Vector2d& place_m);

}  // namespace roundabout::core
