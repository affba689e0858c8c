#pragma once

#include <cstddef>
#include <string>

#include "logs/reading/event_log.h"
#include "logs/types/type_table.h"

namespace roundabout::logs {

/// Which time MCAP messages get.
enum class McapClock {
  kLog,   ///< when the logger received them
  kData,  ///< the utime of the latest VEHICLE_STATES; of flights in lockstep the one to look at
};

struct McapResult {
  std::size_t messages = 0;
  std::size_t raw = 0;       ///< of them of unknown types, as they were on the wire
  std::size_t rejected = 0;  ///< could not be decoded; left out
};

/// Writes the log as MCAP (https://mcap.dev/spec): messages as JSON with a JSON schema each,
/// chunked and indexed, without compression. Messages of unknown types keep their bytes, with
/// message encoding "lcm" and no schema. Throws core::StartupError if the file cannot be written.
McapResult writeMcap(const EventLog& log, const TypeTable& types, McapClock clock,
                     const std::string& file);

}  // namespace roundabout::logs
