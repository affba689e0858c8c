#include "logs/reading/event_scan.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <spdlog/fmt/fmt.h>

#include "common/bus/plausible.h"

namespace roundabout::logs {

namespace {

constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kNumberAt = 4;
constexpr std::size_t kLogUtimeAt = 12;
constexpr std::size_t kChannelLengthAt = 20;
constexpr std::size_t kDataLengthAt = 24;
constexpr std::size_t kSmallestEventBytes = kHeaderBytes + 1;
// Times the size of the log.
constexpr std::size_t kSearchBudget = 16;

std::string_view textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class Scanner {
 public:
  explicit Scanner(std::span<const std::byte> log)
      : log_(log), budget_(kSearchBudget * log.size()) {}

  EventScan scan() {
    EventScan result;
    std::size_t position = 0;
    while (position < log_.size()) {
      std::string problem;
      if (const std::size_t end = eventEnd(position, problem); end != kNowhere) {
        result.offsets.push_back(position);
        result.log_utimes.push_back(
            static_cast<core::Utime>(bus::bigEndian(log_, position + kLogUtimeAt, 8)));
        last_number_ = numberAt(position);
        position = end;
        continue;
      }
      const std::size_t next = nextEvent(position + 1);
      result.damage.places.push_back({"", position, next - position, problem});
      position = next;
    }
    return result;
  }

 private:
  bool syncAt(std::size_t position) const {
    return position + 4 <= log_.size() && bus::bigEndian(log_, position, 4) == kSyncWord;
  }

  std::size_t findSync(std::size_t from) const {
    static constexpr std::string_view kSync("\xED\xA1\xDA\x01", 4);
    const std::size_t found = textOf(log_).find(kSync, from);
    return found == std::string_view::npos ? log_.size() : found;
  }

  /// Where the event at the position says that it ends; kNowhere and a problem if it cannot be one.
  std::size_t claimedEnd(std::size_t position, std::string& problem) const {
    if (!syncAt(position)) {
      problem = "no sync word";
      return kNowhere;
    }
    if (position + kHeaderBytes > log_.size()) {
      problem = "the file ends within a header";
      return kNowhere;
    }
    const std::size_t channel_bytes = bus::bigEndian(log_, position + kChannelLengthAt, 4);
    const std::size_t data_bytes = bus::bigEndian(log_, position + kDataLengthAt, 4);
    if (channel_bytes == 0 || channel_bytes > kMaxChannelBytes) {
      problem = fmt::format("a channel name of {} bytes", channel_bytes);
      return kNowhere;
    }
    if (data_bytes > std::numeric_limits<std::int32_t>::max()) {
      problem = fmt::format("a payload of {} bytes", data_bytes);
      return kNowhere;
    }
    const std::size_t end = position + kHeaderBytes + channel_bytes + data_bytes;
    if (end > log_.size()) {
      problem = fmt::format("an event that ends {} bytes after the file", end - log_.size());
      return kNowhere;
    }
    const std::string_view channel = textOf(log_.subspan(position + kHeaderBytes, channel_bytes));
    if (!std::all_of(channel.begin(), channel.end(), [](char c) { return c > ' ' && c <= '~'; })) {
      problem = "a channel name that is not printable";
      return kNowhere;
    }
    return end;
  }

  bool startsAfresh(std::size_t position) const {
    return position == log_.size() || syncAt(position);
  }

  /// The first event at or after a position whose end meets a sync word or the end of the file.
  /// Asked for ever larger positions, so that the whole scan stays linear.
  std::size_t nextChained(std::size_t from) {
    if (chained_ < from || !chained_known_) {
      chained_known_ = true;
      std::string ignored;
      for (chained_ = findSync(from); chained_ < log_.size(); chained_ = findSync(chained_ + 1)) {
        const std::size_t end = claimedEnd(chained_, ignored);
        if (end != kNowhere && startsAfresh(end)) {
          break;
        }
      }
    }
    return chained_;
  }

  std::uint64_t numberAt(std::size_t position) const {
    return bus::bigEndian(log_, position + kNumberAt, 8);
  }

  bool numberedInOrder(std::size_t position, std::size_t next) const {
    return next + kHeaderBytes <= log_.size() && numberAt(next) == numberAt(position) + 1;
  }

  /// Whether what looks like an event within the extent of another one is an event of this log, by
  /// its number, and not one that a payload carries.
  bool belongs(std::size_t hidden, std::size_t position, std::size_t end) const {
    const std::uint64_t most = 1 + (end - position) / kSmallestEventBytes;
    const std::uint64_t number = numberAt(hidden);
    const auto follows = [&](std::uint64_t before) {
      return number > before && number - before <= most;
    };
    return follows(numberAt(position)) || follows(last_number_);
  }

  std::size_t eventEnd(std::size_t position, std::string& problem) {
    const std::size_t end = claimedEnd(position, problem);
    if (end == kNowhere || (startsAfresh(end) && numberedInOrder(position, end))) {
      return end;
    }
    if (hidesAnEvent(position, end)) {
      problem = "lengths that swallow the next event";
      return kNowhere;
    }
    return end;
  }

  bool hidesAnEvent(std::size_t position, std::size_t end) {
    if (nextChained(position + 4) >= end || end - position > budget_) {
      return false;
    }
    budget_ -= end - position;
    std::string ignored;
    std::size_t hidden = nextChained(position + 4);
    while (hidden < end) {
      const std::size_t hidden_end = claimedEnd(hidden, ignored);
      if (hidden_end == kNowhere || !startsAfresh(hidden_end)) {
        hidden = findSync(hidden + 1);
        continue;
      }
      const bool crosses = hidden_end > end && !startsAfresh(end);
      if (crosses || belongs(hidden, position, end)) {
        return true;
      }
      hidden = findSync(hidden_end);
    }
    return false;
  }

  std::size_t nextEvent(std::size_t from) {
    std::string ignored;
    std::size_t position = findSync(from);
    while (position < log_.size() && eventEnd(position, ignored) == kNowhere) {
      position = findSync(position + 1);
    }
    return position;
  }

  std::span<const std::byte> log_;
  std::size_t chained_ = 0;
  bool chained_known_ = false;
  std::uint64_t last_number_ = 0;  // of the event found last
  std::size_t budget_;             // bytes to search for hidden events, so that all stays linear
};

}  // namespace

std::size_t DamageReport::skippedBytes() const {
  return std::accumulate(places.begin(), places.end(), std::size_t{0},
                         [](std::size_t sum, const Damage& place) { return sum + place.bytes; });
}

EventScan scanEvents(std::span<const std::byte> log) { return Scanner(log).scan(); }

Event eventAt(std::span<const std::byte> log, std::size_t offset) {
  const std::size_t channel_bytes = bus::bigEndian(log, offset + kChannelLengthAt, 4);
  const std::size_t data_bytes = bus::bigEndian(log, offset + kDataLengthAt, 4);
  return {static_cast<std::int64_t>(bus::bigEndian(log, offset + kNumberAt, 8)),
          static_cast<core::Utime>(bus::bigEndian(log, offset + kLogUtimeAt, 8)),
          textOf(log.subspan(offset + kHeaderBytes, channel_bytes)),
          log.subspan(offset + kHeaderBytes + channel_bytes, data_bytes)};
}

}  // namespace roundabout::logs
