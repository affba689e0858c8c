#pragma once

#include <cstddef>
#include <iterator>
#include <memory>
#include <string>

#include "logs/reading/event_scan.h"

namespace roundabout::logs {

/// An LCM event log on disk, mapped into memory. Events are reached in the order of the file; what
/// they refer to lives as long as the log.
class EventLog {
 public:
  class Iterator;

  /// Throws core::StartupError if the file is missing, unreadable or holds no event at all.
  explicit EventLog(const std::string& path);
  ~EventLog();
  EventLog(EventLog&&) noexcept;
  EventLog& operator=(EventLog&&) noexcept;

  std::size_t size() const { return scan_.offsets.size(); }
  Event operator[](std::size_t index) const;
  Iterator begin() const;
  Iterator end() const;

  const DamageReport& damage() const { return scan_.damage; }
  const std::string& path() const { return path_; }
  std::size_t fileBytes() const;

 private:
  class MappedFile;

  std::string path_;
  std::unique_ptr<MappedFile> file_;
  EventScan scan_;
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
