#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "common/core/time.h"

namespace roundabout::core {

/// Says on which frames a periodic process acts. Ticks are the multiples of the period in data
/// time, so that everybody who uses the same period acts on the same frames, live or replayed.
class TickTimer {
 public:
  explicit TickTimer(double rate_hz) : period_us_(toUtime(1.0 / rate_hz)) {}

  /// True for the first frame at or after each tick. A frame that is older than an earlier one is
  /// never a tick.
  bool due(Utime frame_utime) {
    const Utime tick = frame_utime / period_us_;
    if (started_ && tick <= last_tick_) {
      return false;
    }
    const std::int64_t missed = missed_ + (started_ ? tick - last_tick_ - 1 : 0);
    missed_ = static_cast<int>(std::min<std::int64_t>(missed, std::numeric_limits<int>::max()));
    started_ = true;
    last_tick_ = tick;
    return true;
  }

  /// Ticks that passed without a frame; stays at the largest int.
  int missed() const { return missed_; }
  Utime periodUs() const { return period_us_; }

 private:
  Utime period_us_;
  Utime last_tick_ = 0;
  bool started_ = false;
  int missed_ = 0;
};

}  // namespace roundabout::core
