#pragma once

#include <cstdint>

namespace roundabout::core {

/// What a planner does, as in lcmtypes/planner_status_t.lcm.
enum class PlannerMode : std::int8_t {
  kNeverHeard = -1,  ///< only in vehicle_progress_t
  kWaiting = 0,
  kOnFloor = 1,
  kTakingOff = 2,
  kFlying = 3,
  kAtGoal = 4,
  kHolding = 5,
  kLanding = 6,
  kLanded = 7,
  kKilled = 8
};

/// The message's word in lower case; "unknown" for a number that is none.
constexpr const char* nameOf(PlannerMode mode) {
  switch (mode) {
    case PlannerMode::kNeverHeard:
      return "never_heard";
    case PlannerMode::kWaiting:
      return "waiting";
    case PlannerMode::kOnFloor:
      return "on_floor";
    case PlannerMode::kTakingOff:
      return "taking_off";
    case PlannerMode::kFlying:
      return "flying";
    case PlannerMode::kAtGoal:
      return "at_goal";
    case PlannerMode::kHolding:
      return "holding";
    case PlannerMode::kLanding:
      return "landing";
    case PlannerMode::kLanded:
      return "landed";
    case PlannerMode::kKilled:
      return "killed";
  }
  return "unknown";
}

}  // namespace roundabout::core
