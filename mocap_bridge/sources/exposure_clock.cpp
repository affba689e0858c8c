#include "mocap_bridge/sources/exposure_clock.h"

#include <algorithm>
#include <cmath>

namespace roundabout::mocap_bridge {

namespace {

constexpr core::Utime kOldest = core::kMicrosPerSecond;
// What clocks may be wrong by.
constexpr core::Utime kAhead = 2'000;
// As much as ClockMap learns from; it sets the clock anew by what is faster.
constexpr core::Utime kFaster = 20'000;
constexpr core::Utime kLearn = core::kMicrosPerSecond / 5;
// No clock shows more; microseconds of it can be added without overflow.
constexpr double kLargest_s = 1e11;

}  // namespace

bool ExposureClock::possible(double stamp_s) { return std::abs(stamp_s) <= kLargest_s; }

std::optional<core::Utime> ExposureClock::mapped(const Stamps& stamps, core::Utime received) const {
  const double sent_s = *(stamps.sent_s ? stamps.sent_s : stamps.exposure_s);
  const bool echoes = echo_.ready();
  core::Utime sent = received;
  if (echoes) {
    sent = echo_.toLocal(sent_s);
  } else if (arrivals_.ready()) {
    sent = arrivals_.toLocal(sent_s);
    if (sent > received + kFaster) {
      return std::nullopt;
    }
    sent = std::min(received, sent);
  }
  if (stamps.exposure_s && stamps.sent_s) {
    return sent - core::toUtime(*stamps.sent_s - *stamps.exposure_s);
  }
  return stamps.exposure_s && echoes ? sent : sent - latency_;
}

std::optional<core::Utime> ExposureClock::exposureOf(const Stamps& stamps, core::Utime received) {
  if (!stamps.sent_s && !stamps.exposure_s) {
    return received - latency_;
  }
  if (!possible(stamps.sent_s.value_or(0.0)) || !possible(stamps.exposure_s.value_or(0.0))) {
    return std::nullopt;
  }
  arrivals_.addArrival(*(stamps.sent_s ? stamps.sent_s : stamps.exposure_s), received);
  learning_ = learning_ && arrivals_.span() < kLearn && !echo_.ready();
  const std::optional<core::Utime> exposure = mapped(stamps, received);
  const bool believable =
      exposure && *exposure <= received + kAhead && *exposure >= received - kOldest;
  return believable && !learning_ ? exposure : std::nullopt;
}

}  // namespace roundabout::mocap_bridge
