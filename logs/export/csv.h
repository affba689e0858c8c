#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "logs/flight.h"
#include "logs/reading/event_log.h"
#include "logs/types/type_table.h"

namespace roundabout::logs {

/// One file that was written, or why none was.
struct CsvFile {
  std::string channel;  ///< empty: the table of all vehicles
  std::string file;     ///< empty: not written
  std::size_t rows = 0;
  std::size_t rejected = 0;  ///< messages that could not be decoded
  std::string problem;
};

/// Writes <folder>/<channel>.csv for every channel with a known type: a row a message, a column a
/// number, lists spread over as many columns as the longest needs. Headers carry units. Columns
/// log_time and log_utime say when the logger received it. Throws core::StartupError if a file
/// cannot be written.
std::vector<CsvFile> writeChannelTables(const EventLog& log, const TypeTable& types,
                                        const std::string& folder);

/// One row a vehicle and frame: time, place, velocity, goal, command in force, mode. Throws as
/// above.
CsvFile writeVehicleTable(const Flight& flight, const std::string& file);

}  // namespace roundabout::logs
