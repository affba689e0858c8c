#include "logs/reading/channel_summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/bus/plausible.h"

namespace roundabout::logs {

namespace {

constexpr double kGapMedians = 3.0;
constexpr std::size_t kMostDamageLines = 20;

/// The name of the type that a payload starts as.
std::string typeOf(std::span<const std::byte> payload, const TypeTable& types) {
  if (payload.size() < sizeof(std::uint64_t)) {
    return "too short";
  }
  const std::uint64_t fingerprint = bus::fingerprintOf(payload);
  const MessageType* type = types.find(fingerprint);
  return type == nullptr ? fmt::format("{:016x}", fingerprint) : type->name;
}

struct Collected {
  std::uint64_t fingerprint = 0;
  std::string type;
  std::size_t bytes = 0;
  std::vector<core::Utime> log_utimes;
};

ChannelSummary summaryOf(const std::string& channel, const Collected& collected,
                         core::Utime begin) {
  ChannelSummary summary;
  summary.channel = channel;
  summary.type = collected.type;
  summary.messages = static_cast<int>(collected.log_utimes.size());
  summary.mean_bytes = static_cast<double>(collected.bytes) / summary.messages;
  summary.first_at_s = core::toSeconds(collected.log_utimes.front() - begin);
  summary.last_at_s = core::toSeconds(collected.log_utimes.back() - begin);
  if (summary.messages == 1) {
    return summary;
  }
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < collected.log_utimes.size(); ++i) {
    intervals_s.push_back(core::toSeconds(collected.log_utimes[i] - collected.log_utimes[i - 1]));
  }
  const double span_s = summary.last_at_s - summary.first_at_s;
  summary.rate_hz = span_s > 0.0 ? (summary.messages - 1) / span_s : 0.0;
  summary.median_interval_s = medianOf(intervals_s);
  summary.longest_gap_s = *std::max_element(intervals_s.begin(), intervals_s.end());
  for (double& interval_s : intervals_s) {
    summary.gaps += interval_s > kGapMedians * summary.median_interval_s ? 1 : 0;
    interval_s = std::abs(interval_s - summary.median_interval_s);
  }
  summary.jitter_s = spreadOf(std::move(intervals_s));
  return summary;
}

}  // namespace

std::vector<ChannelSummary> summarizeChannels(const EventLog& log, const TypeTable& types) {
  std::map<std::string, Collected, std::less<>> channels;
  for (const Event& event : log) {
    auto found = channels.find(event.channel);
    if (found == channels.end()) {
      found = channels.emplace(event.channel, Collected()).first;
    }
    Collected& collected = found->second;
    const std::uint64_t fingerprint =
        event.payload.size() < sizeof(std::uint64_t) ? 0 : bus::fingerprintOf(event.payload);
    if (collected.log_utimes.empty()) {
      collected.type = typeOf(event.payload, types);
    } else if (fingerprint != collected.fingerprint) {
      collected.type = "mixed";
    }
    collected.fingerprint = fingerprint;
    collected.bytes += event.payload.size();
    collected.log_utimes.push_back(event.log_utime);
  }
  std::vector<ChannelSummary> summaries;
  for (const auto& [channel, collected] : channels) {
    summaries.push_back(summaryOf(channel, collected, log[0].log_utime));
  }
  return summaries;
}

std::string describe(const EventLog& log, const TypeTable& types) {
  const Event first = log[0];
  const Event last = log[log.size() - 1];
  std::string text =
      fmt::format("{}: {} events, {:.1f} MB, {:.3f} s of wall clock from utime {}\n\n", log.path(),
                  log.size(), static_cast<double>(log.fileBytes()) / 1e6,
                  core::toSeconds(last.log_utime - first.log_utime), first.log_utime);
  if (log.files().size() > 1) {
    text += fmt::format("in {} parts: {}\n\n", log.files().size(), fmt::join(log.files(), ", "));
  }
  text += fmt::format("{:<26} {:<18} {:>8} {:>9} {:>8} {:>10} {:>10} {:>6} {:>10}  {}\n", "channel",
                      "type", "count", "Hz", "bytes", "median ms", "p99 jit ms", "gaps",
                      "longest s", "from..to s");
  for (const ChannelSummary& channel : summarizeChannels(log, types)) {
    const std::string jitter =
        channel.jitter_s.count == 0 ? "-" : fmt::format("{:.3f}", channel.jitter_s.p99 * 1e3);
    text += fmt::format(
        "{:<26} {:<18} {:>8} {:>9.2f} {:>8.0f} {:>10.3f} {:>10} {:>6} {:>10.3f}  {:.1f}..{:.1f}\n",
        channel.channel, channel.type, channel.messages, channel.rate_hz, channel.mean_bytes,
        channel.median_interval_s * 1e3, jitter, channel.gaps, channel.longest_gap_s,
        channel.first_at_s, channel.last_at_s);
  }
  const DamageReport& damage = log.damage();
  text += damage.empty() ? std::string("\nno damage\n")
                         : fmt::format("\ndamaged in {} places, {} bytes skipped\n",
                                       damage.places.size(), damage.skippedBytes());
  for (std::size_t i = 0; i < std::min(damage.places.size(), kMostDamageLines); ++i) {
    const Damage& place = damage.places[i];
    text += fmt::format("  {}{}at byte {}: {} bytes skipped, {}\n", place.file,
                        place.file.empty() ? "" : " ", place.offset, place.bytes, place.reason);
  }
  if (damage.places.size() > kMostDamageLines) {
    text += fmt::format("  and {} more\n", damage.places.size() - kMostDamageLines);
  }
  return text;
}

}  // namespace roundabout::logs
