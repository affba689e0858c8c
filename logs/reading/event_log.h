#pragma once

#include <cstddef>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "logs/reading/event_scan.h"

namespace roundabout::logs {

/// Bytes. Smaller logs are scanned sooner than an index of theirs is worth the clutter.
inline constexpr std::size_t kSmallestIndexedLog = 64 << 20;

/// An LCM event log on disk, mapped into memory. Events are reached in the order of the file; what
/// they refer to lives as long as the log.
///
/// A log that lcm-logger has split (FILE.00, FILE.01, …) or rotated (FILE.0 is the newest) is one
/// log by the name FILE, if there is no file of that name. Its parts follow each other by the log
/// time of their first event.
class EventLog {
 public:
  class Iterator;

  /// A part of at least `indexed_bytes` gets an index beside it (FILE.index), where the folder can
  /// be written to, and is not scanned again until it changes. Throws core::StartupError if the
  /// file is missing, unreadable or holds no event at all.
  explicit EventLog(const std::string& path, std::size_t indexed_bytes = kSmallestIndexedLog);
  ~EventLog();
  EventLog(EventLog&&) noexcept;
  EventLog& operator=(EventLog&&) noexcept;

  std::size_t size() const { return size_; }
  Event operator[](std::size_t index) const;
  Iterator begin() const;
  Iterator end() const;

  /// us. Without touching the event.
  core::Utime logUtime(std::size_t index) const;
  /// The first event logged at or after a time; size() if there is none. Single corrupt times do
  /// not lead it astray. Of a log whose clock was set back, one of the places that fit.
  std::size_t indexAt(core::Utime log_utime) const;

  const DamageReport& damage() const { return damage_; }
  const std::string& path() const { return path_; }
  /// One, unless the log was split.
  std::vector<std::string> files() const;
  std::size_t fileBytes() const;

 private:
  struct Part;

  const Part& partOf(std::size_t index) const;
  core::Utime typicalUtime(std::size_t index) const;

  std::string path_;
  std::vector<Part> parts_;
  std::size_t size_ = 0;
  DamageReport damage_;
};

class EventLog::Iterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = Event;
  using difference_type = std::ptrdiff_t;
  using pointer = const Event*;
  using reference = Event;

  Iterator(const EventLog& log, std::size_t index) : log_(&log), index_(index) {}

  Event operator*() const { return (*log_)[index_]; }
  Iterator& operator++() {
    ++index_;
    return *this;
  }
  bool operator==(const Iterator& other) const { return index_ == other.index_; }

 private:
  const EventLog* log_;
  std::size_t index_;
};

inline EventLog::Iterator EventLog::begin() const { return {*this, 0}; }
inline EventLog::Iterator EventLog::end() const { return {*this, size()}; }

}  // namespace roundabout::logs
