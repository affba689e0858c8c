#pragma once

#include "planner/shield/point_set.h"

namespace roundabout::planner::shield {

/// Two convex hulls, and the line that keeps the greatest distance from both.
struct ConvexGap {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit, from the first to the second
  double distance_m = 0.0;  ///< between the hulls along the normal; negative: they overlap
};

/// Gilbert-Johnson-Keerthi distance of the hulls of two sets of points, neither empty. Swapped sets
/// give the opposite normal. Hulls that overlap are measured along the line between their centres.
ConvexGap gapBetween(Points first, Points second);
ConvexGap gapBetween(const PointSet& first, Points second);
ConvexGap gapBetween(const PointSet& first, const PointSet& second);

/// Greatest normal . p.
double extentAlong(Points points, const Eigen::Vector2d& normal);

}  // namespace roundabout::planner::shield
