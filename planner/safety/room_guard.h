#pragma once

#include <Eigen/Core>

#include "common/config/experiment.h"

namespace roundabout::planner {

/// Which places in and around the room a vehicle may be sent to, and where it has to land. That it
/// brakes before the edges is the shield's affair.
class RoomGuard {
 public:
  RoomGuard(const config::Room& room, const config::Vehicle& vehicle, double land_margin_m);

  /// The nearest position that keeps the body inside.
  Eigen::Vector3d clipPosition(const Eigen::Vector3d& position_world_m) const;

  /// Farther outside than the margin, in any direction but down: a vehicle lands, a goal is
  /// refused.
  bool mustLand(const Eigen::Vector3d& position_world_m) const;

 private:
  Eigen::Vector3d min_m_;  // of the room
  Eigen::Vector3d max_m_;
  Eigen::Vector3d centre_min_m_;  // of what the vehicle's centre may reach
  Eigen::Vector3d centre_max_m_;
  double land_margin_m_;
};

}  // namespace roundabout::planner
