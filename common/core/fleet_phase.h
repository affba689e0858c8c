#pragma once

#include <cstdint>

namespace roundabout::core {

/// What the fleet is at, as in lcmtypes/fleet_status_t.lcm.
enum class FleetPhase : std::int8_t {
  kWaiting = 0,
  kIdle = 1,
  kTakeOff = 2,
  kGo = 3,
  kHold = 4,
  kLand = 5,
  kDone = 6,
  kFailed = 7
};

/// The message's word in lower case; "unknown" for a number that is none.
constexpr const char* nameOf(FleetPhase phase) {
  switch (phase) {
    case FleetPhase::kWaiting:
      return "waiting";
    case FleetPhase::kIdle:
      return "idle";
    case FleetPhase::kTakeOff:
      return "take_off";
    case FleetPhase::kGo:
      return "go";
    case FleetPhase::kHold:
      return "hold";
    case FleetPhase::kLand:
      return "land";
    case FleetPhase::kDone:
      return "done";
    case FleetPhase::kFailed:
      return "failed";
  }
  return "unknown";
}

}  // namespace roundabout::core
