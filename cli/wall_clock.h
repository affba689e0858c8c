#pragma once

#include <chrono>

#include "common/core/time.h"

namespace roundabout::cli {

/// Seconds on a clock that does not jump; for limits and durations.
inline double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Microseconds since 1970; for the utime of what an operator sends.
inline core::Utime wallTime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace roundabout::cli
