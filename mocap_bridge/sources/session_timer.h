#pragma once

#include "common/core/time.h"

namespace roundabout::mocap_bridge {

/// Says when something periodic is due.
struct SessionTimer {
  core::Utime period = 0;
  core::Utime last = 0;  ///< 0: never

  /// True once a period, the first time at once.
  bool due(core::Utime now) {
    if (last != 0 && now - last < period) {
      return false;
    }
    last = now;
    return true;
  }
  void reset() { last = 0; }
};

}  // namespace roundabout::mocap_bridge
