#include "planner/safety/room_guard.h"

#include <algorithm>
#include <cmath>

namespace roundabout::planner {

namespace {

// What is left for wind, lag of the attitude and wrong parameters.
constexpr double kBrakingShare = 0.5;
// Where approaching ends before the body touches the wall: the vehicle's one acceleration may be
// busy sideways for a moment (measured in the test: 0.14 m at 1.4 m/s). Position control goes
// nearer.
constexpr double kMargin_m = 0.15;
// Slowing down sideways may have this much of a change that brakes in front of a wall.
constexpr double kFreeSlowing_mps = 0.3;

// From `across` toward `wanted`, by at most `change`; by a little more as far as that slows down.
double changeAcross(double across_mps, double wanted_mps, double change_mps) {
  const double changed_mps =
      std::clamp(wanted_mps, across_mps - change_mps, across_mps + change_mps);
  const bool slows = (wanted_mps - across_mps) * across_mps < 0.0;
  if (!slows) {
    return changed_mps;
  }
  const double less_mps = std::min(std::abs(across_mps), change_mps + kFreeSlowing_mps);
  const double slowed_mps = across_mps - std::copysign(less_mps, across_mps);
  return across_mps > 0.0 ? std::min(changed_mps, std::max(slowed_mps, wanted_mps))
                          : std::max(changed_mps, std::min(slowed_mps, wanted_mps));
}

}  // namespace

RoomGuard::RoomGuard(const config::Room& room, const config::Vehicle& vehicle, double land_margin_m,
                     double reaction_s)
    : min_m_(room.min_m),
      max_m_(room.max_m),
      centre_min_m_(room.min_m),
      centre_max_m_(room.max_m),
      land_margin_m_(land_margin_m),
      braking_mps2_(kBrakingShare * vehicle.max_acceleration_mps2),
      reaction_s_(reaction_s) {
  centre_min_m_.head<2>().array() += vehicle.body_radius_m;
  centre_max_m_.head<2>().array() -= vehicle.body_radius_m;
}

Eigen::Vector2d RoomGuard::clipVelocity(const Eigen::Vector2d& position_world_m,
                                        const Eigen::Vector2d& velocity_world_mps,
                                        const Eigen::Vector2d& wanted_world_mps) const {
  // The fastest approach that still ends at the edge: v reaction + v^2 / (2 a) = gap.
  const double lead_mps = braking_mps2_ * reaction_s_;
  const auto limit = [&](double gap_m) {
    return std::sqrt(lead_mps * lead_mps + 2.0 * braking_mps2_ * std::max(0.0, gap_m - kMargin_m)) -
           lead_mps;
  };
  Eigen::Vector2d slowest;
  Eigen::Vector2d fastest;
  for (int axis = 0; axis < 2; ++axis) {
    slowest[axis] = -limit(position_world_m[axis] - centre_min_m_[axis]);
    fastest[axis] = limit(centre_max_m_[axis] - position_world_m[axis]);
  }
  Eigen::Vector2d clipped = wanted_world_mps;
  for (int axis = 0; axis < 2; ++axis) {
    // The vehicle has one acceleration for both directions. While one has to brake, the other asks
    // for no more of it than that, and for a little more where it gets slower.
    const double speed_mps = velocity_world_mps[axis];
    const double excess_mps = std::max(slowest[axis] - speed_mps, speed_mps - fastest[axis]);
    if (excess_mps > 0.0) {
      clipped[1 - axis] =
          changeAcross(velocity_world_mps[1 - axis], wanted_world_mps[1 - axis], excess_mps);
    }
  }
  clipped = clipped.cwiseMax(slowest).cwiseMin(fastest);
  return clipped;
}

Eigen::Vector3d RoomGuard::clipPosition(const Eigen::Vector3d& position_world_m) const {
  return position_world_m.cwiseMax(centre_min_m_).cwiseMin(centre_max_m_);
}

bool RoomGuard::inside(const Eigen::Vector2d& position_world_m) const {
  return (position_world_m.array() >= centre_min_m_.head<2>().array()).all() &&
         (position_world_m.array() <= centre_max_m_.head<2>().array()).all();
}

bool RoomGuard::mustLand(const Eigen::Vector3d& position_world_m) const {
  const Eigen::Vector2d below = min_m_.head<2>() - position_world_m.head<2>();
  const Eigen::Vector3d above = position_world_m - max_m_;
  return std::max(below.maxCoeff(), above.maxCoeff()) > land_margin_m_;
}

}  // namespace roundabout::planner
