#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "planner/linear_program/half_plane.h"

namespace roundabout::planner {

/// What a disc needs to know of itself to keep off obstacles that stand.
struct DiscMotion {
  Eigen::Vector2d velocity_mps;
  double radius_m;
  double max_speed_mps;
  double horizon_s;  ///< within which it is not to touch
};

/// The velocities that ORCA allows a disc at the origin beside a convex obstacle: behind the edge
/// of the velocity obstacle at the point nearest to the disc's own velocity, since who stands makes
/// no change (van den Berg et al. 2011, section 5.4). Whoever keeps one does not touch within the
/// horizon. Zero velocity is always allowed. A disc that touches already may not come nearer.
/// Nothing if the obstacle is out of reach.
///
/// corners_m: a convex polygon, counter-clockwise, or two ends of a line. On the axis of a
/// symmetric obstacle the way past it is the right-hand one.
std::optional<HalfPlane> halfPlaneBeside(std::span<const Eigen::Vector2d> corners_m,
                                         const DiscMotion& disc);

}  // namespace roundabout::planner
