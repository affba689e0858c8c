#pragma once

#include <optional>

#include <Eigen/Core>

namespace roundabout::planner {

/// The shortest change of relative velocity onto the edge of a velocity obstacle: depth * normal.
struct Escape {
  Eigen::Vector2d normal;  ///< unit, out of the obstacle
  double depth_mps;        ///< negative: the relative velocity is outside already
};

/// Two discs touch within time_horizon_s if they keep a relative velocity inside the velocity
/// obstacle (van den Berg et al. 2011, section 4: a cone cut off by an arc; the vector u of
/// ORCA's definition is depth * normal). Discs that overlap already shall come apart within
/// time_step_s. On the axis of the cone the way out is the right-hand one, for both discs.
/// position: other minus self, velocity: self minus other, in one frame. Times > 0. Nothing if no
/// direction is better than another: the centres coincide and so do the velocities.
std::optional<Escape> escapeFrom(const Eigen::Vector2d& relative_position_m,
                                 const Eigen::Vector2d& relative_velocity_mps,
                                 double combined_radius_m, double time_horizon_s,
                                 double time_step_s);

}  // namespace roundabout::planner
