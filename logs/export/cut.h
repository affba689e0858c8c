#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "logs/reading/channel_filter.h"
#include "logs/reading/event_log.h"

namespace roundabout::logs {

struct CutOptions {
  double from_s = 0.0;  ///< wall clock since the first event
  double to_s = std::numeric_limits<double>::infinity();
  std::vector<std::string> only;    ///< channels, as ChannelFilter takes them
  std::vector<std::string> except;  ///< channels
};

/// Writes the chosen events as a log of their own, with their log times, numbered from 0. Returns
/// how many they are. Throws core::StartupError if the file cannot be written or is the log itself.
std::size_t cutLog(const EventLog& log, const CutOptions& options, const std::string& file);

}  // namespace roundabout::logs
