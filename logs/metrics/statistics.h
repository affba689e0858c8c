#pragma once

#include <limits>
#include <vector>

namespace roundabout::logs {

/// Of a set of values; NaN without values. Percentiles are values of the set (nearest rank).
struct Spread {
  int count = 0;
  double p50 = std::numeric_limits<double>::quiet_NaN();
  double p99 = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

Spread spreadOf(std::vector<double> values);

/// Nearest rank; NaN without values.
double medianOf(std::vector<double> values);

}  // namespace roundabout::logs
