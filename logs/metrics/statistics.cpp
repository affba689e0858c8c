#include "logs/metrics/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace roundabout::logs {

namespace {

double nearestRank(std::vector<double>& values, double fraction) {
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(fraction * static_cast<double>(values.size())));
  const auto position = values.begin() + std::max<std::ptrdiff_t>(rank, 1) - 1;
  std::nth_element(values.begin(), position, values.end());
  return *position;
}

}  // namespace

Spread spreadOf(std::vector<double> values) {
  Spread spread;
  spread.count = static_cast<int>(values.size());
  if (!values.empty()) {
    spread.p50 = nearestRank(values, 0.5);
    spread.p99 = nearestRank(values, 0.99);
    spread.max = *std::max_element(values.begin(), values.end());
  }
  return spread;
}

double medianOf(std::vector<double> values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : nearestRank(values, 0.5);
}

}  // namespace roundabout::logs
