#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace roundabout::sim {

/// One person on the floor. World frame.
struct Pedestrian {
  std::int32_t id = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;  ///< of the body, while it stands too
  double gait_rad = 0.0;     ///< phase of the two steps of a stride
};

/// Slower than this somebody stands: neither body nor legs turn.
inline constexpr double kPedestrianStandsMps = 0.1;

/// Advances heading and phase of the gait by the way of a step.
void walk(Pedestrian& person, double step_s);

/// Centres of the two legs at the height of a lidar, left first: side by side when standing, one
/// before the other by up to a quarter of a stride when walking. A stride grows with the root of
/// the speed (1.4 m at 1.4 m/s, as adults walk).
std::array<Eigen::Vector2d, 2> legsOf(const Pedestrian& person);

}  // namespace roundabout::sim
