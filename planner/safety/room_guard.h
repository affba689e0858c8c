#pragma once

#include <Eigen/Core>

#include "common/config/experiment.h"

namespace roundabout::planner {

/// Keeps commands such that the vehicle can brake before the edges of the room.
class RoomGuard {
 public:
  /// reaction_s: from a new command to the first deceleration, an upper bound.
  RoomGuard(const config::Room& room, const config::Vehicle& vehicle, double land_margin_m,
            double reaction_s);

  /// Horizontal velocity (m/s, world) that is as close to `wanted` as braking before the edges
  /// allows.
  Eigen::Vector2d clipVelocity(const Eigen::Vector2d& position_world_m,
                               const Eigen::Vector2d& velocity_world_mps,
                               const Eigen::Vector2d& wanted_world_mps) const;

  /// The nearest position that keeps the body inside.
  Eigen::Vector3d clipPosition(const Eigen::Vector3d& position_world_m) const;

  /// The vehicle's centre may be here, its body touching the wall.
  bool inside(const Eigen::Vector2d& position_world_m) const;

  /// Farther outside than the margin, in any direction but down: a vehicle lands, a goal is
  /// refused.
  bool mustLand(const Eigen::Vector3d& position_world_m) const;

 private:
  Eigen::Vector3d min_m_;  // of the room
  Eigen::Vector3d max_m_;
  Eigen::Vector3d centre_min_m_;  // of what the vehicle's centre may reach
  Eigen::Vector3d centre_max_m_;
  double land_margin_m_;
  double braking_mps2_;
  double reaction_s_;
};

}  // namespace roundabout::planner
