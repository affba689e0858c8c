#pragma once

#include <chrono>

#include "common/core/time.h"

namespace roundabout::mocap_bridge {

/// Unix time when it was made, and from then on the pace of a clock that nobody sets.
class LocalClock {
 public:
  core::Utime now() const {
    return epoch_ + micros(std::chrono::steady_clock::now().time_since_epoch());
  }

 private:
  template <class Duration>
  static core::Utime micros(Duration duration) {
    return std::chrono::duration_cast<std::chrono::microseconds>(duration).count();
  }

  core::Utime epoch_ = micros(std::chrono::system_clock::now().time_since_epoch()) -
                       micros(std::chrono::steady_clock::now().time_since_epoch());
};

}  // namespace roundabout::mocap_bridge
