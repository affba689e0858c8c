#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "logs/metrics/statistics.h"
#include "logs/reading/event_log.h"
#include "logs/types/type_table.h"

namespace roundabout::logs {

/// One channel of a log. Intervals are of log times.
struct ChannelSummary {
  std::string channel;
  std::string type;  ///< by fingerprint; "mixed" for several, the fingerprint of an unknown one
  int messages = 0;
  double mean_bytes = 0.0;
  double first_at_s = 0.0;  ///< after the first event of the log
  double last_at_s = 0.0;
  double rate_hz = 0.0;  ///< 0 for a single message
  double median_interval_s = 0.0;
  Spread jitter_s;  ///< |interval - median|
  double longest_gap_s = 0.0;
  int gaps = 0;  ///< intervals above three medians
};

/// Every channel, by name.
std::vector<ChannelSummary> summarizeChannels(const EventLog& log, const TypeTable& types);

/// What `roundabout log info` prints: size, span, channels, damage.
std::string describe(const EventLog& log, const TypeTable& types);

}  // namespace roundabout::logs
