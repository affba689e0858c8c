#pragma once

#include "cli/console.h"
#include "cli/supervisor.h"

namespace roundabout::cli {

/// Measures the log of a flight, says how it went and, with files, leaves metrics.json, report.html
/// and the pictures in its folder. True if the whole mission was flown, every formation formed and
/// no bodies touched. Throws core::StartupError if a file cannot be read or written.
bool reportFlight(const FlightPlan& plan, const FlightResult& result, bool with_files,
                  Console& console);

}  // namespace roundabout::cli
