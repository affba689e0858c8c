#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "planner/linear_program/half_plane.h"

namespace roundabout::planner {

struct VelocityChoice {
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  double violation_mps = 0.0;  ///< by how much the worst half-plane is missed; 0: all hold
};

/// Chooses a velocity of at most a given speed under half-planes (van den Berg, Guy, Lin, Manocha
/// 2011, sections 5.1 and 5.3).
class LinearProgram {
 public:
  /// The velocity nearest to the preferred one that keeps every half-plane to 1e-10 m/s; if there
  /// is none, the one that misses the worst half-plane by the least. The first `hard` half-planes
  /// are never given up for the others: if they cannot all be kept, the others do not count.
  /// Half-planes, also in changed order, give the same result, unless several velocities are
  /// equally good in the second case. Allocates when there are more half-planes than ever before or
  /// reserved.
  VelocityChoice solve(std::span<const HalfPlane> half_planes, const Eigen::Vector2d& preferred_mps,
                       double max_speed_mps, std::size_t hard = 0);

  void reserve(std::size_t half_planes) { relative_.reserve(half_planes); }

 private:
  std::vector<HalfPlane> relative_;
};

}  // namespace roundabout::planner
