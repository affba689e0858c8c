#pragma once

#include <cmath>
#include <cstdint>

namespace roundabout::core {

/// Data time, microseconds: the utime of messages. Its epoch is the publisher's business.
using Utime = std::int64_t;

constexpr Utime kMicrosPerSecond = 1'000'000;

inline Utime toUtime(double seconds) {
  return static_cast<Utime>(std::llround(seconds * static_cast<double>(kMicrosPerSecond)));
}

constexpr double toSeconds(Utime utime) {
  return static_cast<double>(utime) / static_cast<double>(kMicrosPerSecond);
}

}  // namespace roundabout::core
