#pragma once

#include <cstdint>

namespace roundabout::core {

/// Who decided what a shielded vehicle flies, as in lcmtypes/planner_status_t.lcm. Of several the
/// first that wanted something else than the policy.
enum class ShieldLayer : std::int8_t {
  kNotAsked = -1,  ///< the shield is off, or the command moves nothing
  kNone = 0,       ///< what was wanted is flown
  kHard = 1,       ///< the brake path would have met another vehicle's
  kStatic = 2,     ///< or a wall, an obstacle, a no-fly zone
  kLookAhead = 3,  ///< what was wanted would soon have had to be undone
  kBreaker = 4,    ///< nobody got on
  kStepAside = 5   ///< parked in the way of somebody who asked
};

/// The message's word in lower case; "unknown" for a number that is none.
constexpr const char* nameOf(ShieldLayer layer) {
  switch (layer) {
    case ShieldLayer::kNotAsked:
      return "not_asked";
    case ShieldLayer::kNone:
      return "none";
    case ShieldLayer::kHard:
      return "hard";
    case ShieldLayer::kStatic:
      return "static";
    case ShieldLayer::kLookAhead:
      return "look_ahead";
    case ShieldLayer::kBreaker:
      return "breaker";
    case ShieldLayer::kStepAside:
      return "step_aside";
  }
  return "unknown";
}

}  // namespace roundabout::core
