#pragma once

#include <optional>

#include "common/core/time.h"
#include "mocap_bridge/sources/clock_map.h"

namespace roundabout::mocap_bridge {

/// When frames were exposed, on the local clock, from whatever a system says of its own time.
class ExposureClock {
 public:
  /// Stamps of one frame on the system's clock, seconds; what it does not say is absent.
  struct Stamps {
    std::optional<double> exposure_s;
    std::optional<double> sent_s;  ///< as late as possible before the packet left
  };

  /// `latency_s`: exposure to arrival at its shortest, for systems that do not say it.
  explicit ExposureClock(double latency_s) : latency_(core::toUtime(latency_s)) {}

  /// See ClockMap::addEcho; only where the system answers echoes on the clock of the stamps.
  void addEcho(double remote_s, core::Utime local_middle, double round_trip_s) {
    if (possible(remote_s)) {
      echo_.addEcho(remote_s, local_middle, round_trip_s);
    }
  }

  /// Nothing if the stamps cannot be true: later than the arrival, or more than a second before it,
  /// as those of a backlog that was not read in time. Where only arrivals are known, one may be
  /// 20 ms faster than those before: then it left when it arrived. Nothing either for 0.2 s after a
  /// reset or until echoes are known, since what arrives then may be a backlog. Without any stamp:
  /// arrival minus latency.
  std::optional<core::Utime> exposureOf(const Stamps& stamps, core::Utime received);

  /// The other clock is another one from now on.
  void reset() {
    learning_ = learning_ || arrivals_.span() > 0;
    echo_.reset();
    arrivals_.reset();
  }

 private:
  static bool possible(double stamp_s);
  std::optional<core::Utime> mapped(const Stamps& stamps, core::Utime received) const;

  core::Utime latency_;
  ClockMap echo_;
  ClockMap arrivals_;
  bool learning_ = false;  // after a reset
};

}  // namespace roundabout::mocap_bridge
