#pragma once

#include <cstddef>
#include <vector>

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// The closest pair of every frame and of the time until the next.
struct GapsOverTime {
  struct Entry {
    double body_gap_m;  ///< infinite: no two of which one is off the floor
    core::Utime utime;  ///< when it was so small
    std::size_t vehicle_a;
    std::size_t vehicle_b;
  };
  std::vector<Entry> frames;
};

GapsOverTime gapsOverTime(const Flight& flight);

/// The smallest gap between bodies from frame begin to frame end.
ClosestGap closestIn(const Flight& flight, const GapsOverTime& gaps, std::size_t begin,
                     std::size_t end);

SeparationMetrics separationOf(const Flight& flight);

}  // namespace roundabout::logs
