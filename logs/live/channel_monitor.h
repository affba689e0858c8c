#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/time.h"

namespace roundabout::logs {

/// What is heard on one channel. Rate, jitter and bandwidth are of the last seconds
/// (ChannelMonitor::kWindowS).
struct ChannelState {
  std::string channel;
  std::uint64_t fingerprint = 0;  ///< of the last message; 0: too short for one
  std::uint64_t messages = 0;     ///< since the monitor began
  double rate_hz = 0.0;           ///< 0 for fewer than two messages
  double jitter_s = 0.0;          ///< p99 of |interval - median|
  double bytes_per_s = 0.0;
  double age_s = 0.0;      ///< since the last message
  std::uint64_t gaps = 0;  ///< intervals above three medians, since the monitor began
};

/// Watches channels as messages come. No clock, no wire.
class ChannelMonitor {
 public:
  static constexpr double kWindowS = 5.0;

  void see(std::string_view channel, std::span<const std::byte> payload, core::Utime now);

  /// By name.
  std::vector<ChannelState> states(core::Utime now) const;
  /// The last message; empty if none was heard.
  std::span<const std::byte> last(std::string_view channel) const;

 private:
  struct Arrival {
    core::Utime utime;
    std::size_t bytes;
  };
  struct Channel {
    std::deque<Arrival> recent;
    std::vector<std::byte> last;
    std::uint64_t messages = 0;
    std::uint64_t gaps = 0;
    double median_s = 0.0;  // of the intervals, when last looked at
  };

  static void forget(Channel& channel, core::Utime now);

  std::map<std::string, Channel, std::less<>> channels_;
};

}  // namespace roundabout::logs
