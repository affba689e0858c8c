#include "mocap_bridge/sources/exposure_clock.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr core::Utime kOldest = core::kMicrosPerSecond;
// What clocks may be wrong by.
constexpr core::Utime kAhead = 2'000;

}  // namespace

core::Utime ExposureClock::mapped(const Stamps& stamps, core::Utime received) const {
  const double sent_s = *(stamps.sent_s ? stamps.sent_s : stamps.exposure_s);
  const bool echoes = echo_.ready();
  core::Utime sent = received;
  if (echoes || arrivals_.ready()) {
    sent = (echoes ? echo_ : arrivals_).toLocal(sent_s);
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
  arrivals_.addArrival(*(stamps.sent_s ? stamps.sent_s : stamps.exposure_s), received);
  const core::Utime exposure = mapped(stamps, received);
  if (exposure > received + kAhead || exposure < received - kOldest) {
    reset();
    return std::nullopt;
  }
  return exposure;
}

}  // namespace roundabout::mocap_bridge
