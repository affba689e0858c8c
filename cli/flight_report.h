#pragma once

#include "cli/console.h"
#include "cli/supervisor.h"

namespace roundabout::cli {

/// Measures the log of a flight, says how it went and then, with files, leaves metrics.json,
/// report.html and the pictures in its folder. True if the log is complete and its metrics call the
/// flight a success; files that cannot be written are said on a line and change nothing.
bool reportFlight(const FlightPlan& plan, const FlightResult& result, bool with_files,
                  Console& console);

}  // namespace roundabout::cli
