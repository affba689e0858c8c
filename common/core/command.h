#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <Eigen/Core>

#include "common/core/time.h"

namespace roundabout::core {

/// As in lcmtypes/command_t.lcm.
enum class CommandMode : std::int8_t {
  kVelocity = 0,
  kPosition = 1,
  kHold = 2,
  kLand = 3,
  kKill = 4
};

struct Command {
  Utime utime = 0;
  Utime state_utime = 0;
  std::string vehicle;
  CommandMode mode = CommandMode::kHold;
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  double heading_world_rad = 0.0;
  double heading_rate_radps = 0.0;
  double valid_for_s = 0.0;
  /// Where it is going in the end; NaN: nowhere.
  Eigen::Vector2d goal_world_m =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool asks_for_way = false;  ///< of vehicles that are parked in its way
};

/// As in lcmtypes/goal_t.lcm.
enum class GoalPhase : std::int8_t { kTakeOff = 0, kGo = 1, kLand = 2 };

struct Goal {
  Utime utime = 0;
  std::string vehicle;
  std::int64_t goal_id = 0;
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  double heading_world_rad = 0.0;  ///< NaN: any
  GoalPhase phase = GoalPhase::kTakeOff;
};

/// As in lcmtypes/safety_order_t.lcm.
enum class SafetyOrderKind : std::int8_t { kHold = 0, kLand = 1, kKill = 2, kResume = 3 };

/// The message's word in lower case; "unknown" for a number that is none.
constexpr const char* nameOf(SafetyOrderKind order) {
  switch (order) {
    case SafetyOrderKind::kHold:
      return "hold";
    case SafetyOrderKind::kLand:
      return "land";
    case SafetyOrderKind::kKill:
      return "kill";
    case SafetyOrderKind::kResume:
      return "resume";
  }
  return "unknown";
}

struct SafetyOrder {
  Utime utime = 0;
  std::string vehicle;  ///< empty: all
  SafetyOrderKind order = SafetyOrderKind::kHold;
};

}  // namespace roundabout::core
