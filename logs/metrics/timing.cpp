#include "logs/metrics/timing.h"

#include <algorithm>
#include <cmath>

namespace roundabout::logs {

TimingMetrics timingOf(const Flight& flight) {
  TimingMetrics timing;
  timing.real_time = flight.realTime();
  timing.frames = static_cast<int>(flight.frames.size());
  timing.frames_out_of_order = flight.frames_out_of_order;
  if (flight.frames.size() < 2) {
    return timing;
  }
  std::vector<double> data_intervals_s;
  std::vector<double> log_intervals_s;
  for (std::size_t i = 1; i < flight.frames.size(); ++i) {
    const Frame& before = flight.frames[i - 1];
    const Frame& frame = flight.frames[i];
    const std::int64_t missing = std::max<std::int64_t>(frame.number - before.number - 1, 0);
    timing.missing_frames += missing;
    if (missing == 0) {
      data_intervals_s.push_back(core::toSeconds(frame.utime - before.utime));
    }
    log_intervals_s.push_back(core::toSeconds(frame.log_utime - before.log_utime));
  }
  const Frame& first = flight.frames.front();
  const Frame& last = flight.frames.back();
  timing.data_duration_s = core::toSeconds(last.utime - first.utime);
  timing.log_duration_s = core::toSeconds(last.log_utime - first.log_utime);
  timing.real_time_factor = timing.data_duration_s / timing.log_duration_s;
  timing.nominal_interval_s = medianOf(std::move(data_intervals_s));
  timing.rate_hz = static_cast<double>(log_intervals_s.size()) / timing.log_duration_s;
  timing.longest_interval_s = *std::max_element(log_intervals_s.begin(), log_intervals_s.end());
  for (double& interval_s : log_intervals_s) {
    interval_s = std::abs(interval_s - timing.nominal_interval_s);
  }
  timing.interval_error_s = spreadOf(std::move(log_intervals_s));
  timing.steady = timing.missing_frames == 0 &&
                  std::abs(timing.rate_hz * timing.nominal_interval_s - 1.0) <= kRateTolerance &&
                  timing.interval_error_s.p99 < kIntervalErrorTolerance * timing.nominal_interval_s;
  return timing;
}

}  // namespace roundabout::logs
