#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/time.h"

namespace roundabout::core {

/// One rigid body, as in lcmtypes/vehicle_state_t.lcm.
struct VehicleState {
  std::string name;
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // body to world
  Eigen::Vector3d angular_velocity_body_radps = Eigen::Vector3d::Zero();
  bool tracked = false;
  bool predicted = false;  ///< not tracked, for so short a time that the rest is a prediction
  Utime last_seen = 0;
};

/// All vehicles in one motion-capture frame, as in lcmtypes/vehicle_states_t.lcm.
struct StatesFrame {
  Utime utime = 0;
  std::int64_t frame_number = 0;
  std::vector<VehicleState> vehicles;
  Utime exposure_utime = 0;  ///< of the newest camera frame in it; 0: the same as utime
};

/// Yaw of a body-to-world rotation: the direction of the body's x axis in the floor plane. rad,
/// [-pi, pi].
inline double headingOf(const Eigen::Quaterniond& orientation) {
  const Eigen::Vector3d forward = orientation * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

}  // namespace roundabout::core
