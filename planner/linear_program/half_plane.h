#pragma once

#include <Eigen/Core>

namespace roundabout::planner {

/// The velocities v with normal . v >= offset.
struct HalfPlane {
  Eigen::Vector2d normal;  ///< unit, points to where it holds
  double offset_mps;

  /// Distance of a velocity from the edge: positive where the half-plane holds. m/s.
  double margin(const Eigen::Vector2d& velocity_mps) const {
    return normal.dot(velocity_mps) - offset_mps;
  }
};

}  // namespace roundabout::planner
