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

}  // namespace roundabout::core
