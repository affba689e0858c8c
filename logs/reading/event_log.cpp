#include "logs/reading/event_log.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "logs/reading/event_index.h"
#include "logs/reading/mapped_file.h"

namespace roundabout::logs {

namespace {

namespace fs = std::filesystem;

/// "flight.lcm.07" for "flight.lcm".
bool isPartOf(const std::string& name, const std::string& log) {
  return name.size() > log.size() + 1 && name.starts_with(log + ".") &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(log.size()) + 1, name.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::vector<std::string> filesOf(const std::string& path) {
  std::error_code error;
  std::vector<std::string> files;
  if (!fs::exists(path, error)) {
    const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : ".";
    const std::string log = fs::path(path).filename();
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      if (isPartOf(entry->path().filename(), log)) {
        files.push_back(fs::path(path).has_parent_path() ? entry->path().string()
                                                         : entry->path().filename().string());
      }
    }
  }
  if (files.empty()) {
    files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

struct EventLog::Part {
  std::string file;
  std::unique_ptr<MappedFile> mapped;
  EventScan scan;
  std::size_t first_index = 0;

  Part(std::string name, std::size_t indexed_bytes)
      : file(std::move(name)), mapped(std::make_unique<MappedFile>(file)) {
    const bool indexed = mapped->bytes().size() >= indexed_bytes;
    if (auto known = indexed ? readIndex(file, *mapped) : std::nullopt) {
      scan = std::move(*known);
      return;
    }
    scan = scanEvents(mapped->bytes());
    if (indexed) {
      writeIndex(file, *mapped, scan);
    }
  }
};

EventLog::EventLog(const std::string& path, std::size_t indexed_bytes) : path_(path) {
  for (const std::string& file : filesOf(path)) {
    parts_.emplace_back(file, indexed_bytes);
  }
  std::stable_sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) {
    return !a.scan.log_utimes.empty() &&
           (b.scan.log_utimes.empty() || a.scan.log_utimes.front() < b.scan.log_utimes.front());
  });
  for (Part& part : parts_) {
    part.first_index = size_;
    size_ += part.scan.offsets.size();
    for (Damage& place : part.scan.damage.places) {
      place.file = parts_.size() > 1 ? part.file : "";
      damage_.places.push_back(place);
    }
  }
  if (size_ == 0) {
    throw core::StartupError(path, "log", kExpectedLog,
                             fileBytes() == 0
                                 ? "an empty file"
                                 : fmt::format("{} bytes without one event", fileBytes()));
  }
}

EventLog::~EventLog() = default;
EventLog::EventLog(EventLog&&) noexcept = default;
EventLog& EventLog::operator=(EventLog&&) noexcept = default;

const EventLog::Part& EventLog::partOf(std::size_t index) const {
  std::size_t part = parts_.size() - 1;
  while (parts_[part].first_index > index) {
    --part;
  }
  return parts_[part];
}

Event EventLog::operator[](std::size_t index) const {
  const Part& part = partOf(index);
  return eventAt(part.mapped->bytes(), part.scan.offsets[index - part.first_index]);
}

core::Utime EventLog::logUtime(std::size_t index) const {
  const Part& part = partOf(index);
  return part.scan.log_utimes[index - part.first_index];
}

/// The median around an event: a corrupt time is not in the middle of its neighbours'.
core::Utime EventLog::typicalUtime(std::size_t index) const {
  std::array<core::Utime, 5> utimes{};
  const std::size_t count = std::min(utimes.size(), size_);
  const std::size_t first = std::min(index - std::min<std::size_t>(index, 2), size_ - count);
  for (std::size_t i = 0; i < count; ++i) {
    utimes[i] = logUtime(first + i);
  }
  std::sort(utimes.begin(), utimes.begin() + static_cast<std::ptrdiff_t>(count));
  return utimes[std::clamp<std::size_t>(index - first, 0, count - 1)];
}

std::size_t EventLog::indexAt(core::Utime log_utime) const {
  std::size_t low = 0;
  std::size_t high = size_;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (typicalUtime(middle) < log_utime) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

std::vector<std::string> EventLog::files() const {
  std::vector<std::string> files;
  for (const Part& part : parts_) {
    files.push_back(part.file);
  }
  return files;
}

std::size_t EventLog::fileBytes() const {
  std::size_t bytes = 0;
  for (const Part& part : parts_) {
    bytes += part.mapped->bytes().size();
  }
  return bytes;
}

}  // namespace roundabout::logs
