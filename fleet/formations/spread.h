#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fleet/formations/stroke_font.h"

namespace roundabout::fleet {

/// `count` points on the strokes that show their shape best: every piece of stroke is near a
/// point, with equal gaps along a line, and ends and corners have points of their own as far as
/// `count` allows. Deterministic. Precondition: the strokes have a length.
std::vector<Eigen::Vector2d> spreadForShape(const std::vector<Stroke>& strokes, std::size_t count);

/// As many points on the strokes as `start` has, as far from each other as a local search finds,
/// and never closer together than those of `start`.
std::vector<Eigen::Vector2d> spreadForSpacing(const std::vector<Stroke>& strokes,
                                              std::vector<Eigen::Vector2d> start);

/// Smallest distance between any two points; infinite below two.
double closestPair(const std::vector<Eigen::Vector2d>& points);

}  // namespace roundabout::fleet
