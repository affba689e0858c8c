#include "planner/safety/room_guard.h"

#include <algorithm>

namespace roundabout::planner {

RoomGuard::RoomGuard(const config::Room& room, const config::Vehicle& vehicle, double land_margin_m)
    : min_m_(room.min_m),
      max_m_(room.max_m),
      centre_min_m_(room.min_m),
      centre_max_m_(room.max_m),
      land_margin_m_(land_margin_m) {
  centre_min_m_.head<2>().array() += vehicle.body_radius_m;
  centre_max_m_.head<2>().array() -= vehicle.body_radius_m;
}

Eigen::Vector3d RoomGuard::clipPosition(const Eigen::Vector3d& position_world_m) const {
  return position_world_m.cwiseMax(centre_min_m_).cwiseMin(centre_max_m_);
}

bool RoomGuard::mustLand(const Eigen::Vector3d& position_world_m) const {
  const Eigen::Vector2d below = min_m_.head<2>() - position_world_m.head<2>();
  const Eigen::Vector3d above = position_world_m - max_m_;
  return std::max(below.maxCoeff(), above.maxCoeff()) > land_margin_m_;
}

}  // namespace roundabout::planner
