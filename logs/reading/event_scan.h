#pragma once

// The LCM event log format, docs/formats/event_log.md.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/time.h"

namespace roundabout::logs {

inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
inline constexpr std::size_t kHeaderBytes = 28;
/// LCM_MAX_CHANNEL_NAME_LENGTH.
inline constexpr std::size_t kMaxChannelBytes = 63;

/// One logged message. Refers to the log's memory.
struct Event {
  std::int64_t number = 0;
  core::Utime log_utime = 0;  ///< us, wall clock of the logger when it received the message
  std::string_view channel;
  std::span<const std::byte> payload;
};

/// Bytes that are no event.
struct Damage {
  std::string file;        ///< of a log of several files; else empty
  std::size_t offset = 0;  ///< from the start of the file
  std::size_t bytes = 0;
  std::string reason;
};

/// What a reader had to skip.
struct DamageReport {
  std::vector<Damage> places;  ///< in the order of the file

  bool empty() const { return places.empty(); }
  std::size_t skippedBytes() const;
};

/// Where the events of a log start.
struct EventScan {
  std::vector<std::size_t> offsets;
  std::vector<core::Utime> log_utimes;  ///< one an event
  DamageReport damage;
};

/// Finds every event of a log, however damaged: after bytes that are no event it goes on at the
/// next sync word that starts one. An event is believed unless its extent hides an undamaged event:
/// then its lengths are what is damaged. docs/formats/event_log.md has the rules. Never throws on
/// content; linear in the size.
EventScan scanEvents(std::span<const std::byte> log);

/// Precondition: the offset is one that scanEvents() found.
Event eventAt(std::span<const std::byte> log, std::size_t offset);

}  // namespace roundabout::logs
