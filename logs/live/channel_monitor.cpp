#include "logs/live/channel_monitor.h"

#include <algorithm>
#include <cmath>

#include "common/bus/plausible.h"
#include "logs/metrics/statistics.h"

namespace roundabout::logs {

namespace {

constexpr double kGapMedians = 3.0;
// A median of fewer intervals says nothing about gaps.
constexpr std::size_t kFewestForGaps = 4;
constexpr std::uint64_t kMedianEvery = 16;  // messages

template <class Arrivals>
std::vector<double> intervalsOf(const Arrivals& arrivals) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < arrivals.size(); ++i) {
    intervals_s.push_back(core::toSeconds(arrivals[i].utime - arrivals[i - 1].utime));
  }
  return intervals_s;
}

}  // namespace

void ChannelMonitor::forget(Channel& channel, core::Utime now) {
  while (channel.recent.size() > 2 &&
         core::toSeconds(now - channel.recent.front().utime) > kWindowS) {
    channel.recent.pop_front();
  }
}

void ChannelMonitor::see(std::string_view name, std::span<const std::byte> payload,
                         core::Utime now) {
  auto found = channels_.find(name);
  if (found == channels_.end()) {
    found = channels_.emplace(std::string(name), Channel()).first;
  }
  Channel& channel = found->second;
  if (!channel.recent.empty() && channel.median_s > 0.0) {
    const double interval_s = core::toSeconds(now - channel.recent.back().utime);
    channel.gaps += interval_s > kGapMedians * channel.median_s ? 1 : 0;
  }
  channel.recent.push_back({now, payload.size()});
  channel.last.assign(payload.begin(), payload.end());
  forget(channel, now);
  if (channel.messages++ % kMedianEvery == kFewestForGaps || channel.median_s == 0.0) {
    auto intervals_s = intervalsOf(channel.recent);
    channel.median_s = intervals_s.size() < kFewestForGaps ? 0.0 : medianOf(std::move(intervals_s));
  }
}

std::vector<ChannelState> ChannelMonitor::states(core::Utime now) const {
  std::vector<ChannelState> states;
  for (const auto& [name, channel] : channels_) {
    ChannelState& state = states.emplace_back();
    state.channel = name;
    state.messages = channel.messages;
    state.gaps = channel.gaps;
    state.fingerprint = channel.last.size() < 8 ? 0 : bus::fingerprintOf(channel.last);
    state.age_s = core::toSeconds(now - channel.recent.back().utime);
    std::vector<double> intervals_s = intervalsOf(channel.recent);
    const double span_s =
        core::toSeconds(channel.recent.back().utime - channel.recent.front().utime);
    if (state.age_s > kWindowS || intervals_s.empty() || span_s <= 0.0) {
      continue;
    }
    state.rate_hz = static_cast<double>(intervals_s.size()) / span_s;
    std::size_t bytes = 0;
    for (std::size_t i = 1; i < channel.recent.size(); ++i) {
      bytes += channel.recent[i].bytes;
    }
    state.bytes_per_s = static_cast<double>(bytes) / span_s;
    const double median_s = medianOf(intervals_s);
    for (double& interval_s : intervals_s) {
      interval_s = std::abs(interval_s - median_s);
    }
    state.jitter_s = spreadOf(std::move(intervals_s)).p99;
  }
  return states;
}

std::span<const std::byte> ChannelMonitor::last(std::string_view channel) const {
  const auto found = channels_.find(channel);
  return found == channels_.end() ? std::span<const std::byte>() : found->second.last;
}

}  // namespace roundabout::logs
