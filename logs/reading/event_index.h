#pragma once

// The side index of a log, docs/formats/log_index.md.

#include <optional>
#include <string>

#include "logs/reading/event_scan.h"
#include "logs/reading/mapped_file.h"

namespace roundabout::logs {

/// "flight.lcm.index"
std::string indexFileOf(const std::string& log_file);

/// What a scan of the log found when the index was written; nothing if there is no index, or it is
/// damaged, or the log has changed since.
std::optional<EventScan> readIndex(const std::string& log_file, const MappedFile& log);

/// Replaces the index, whole or not at all. False if it cannot be written: the log can be read
/// without one.
bool writeIndex(const std::string& log_file, const MappedFile& log, const EventScan& scan);

}  // namespace roundabout::logs
