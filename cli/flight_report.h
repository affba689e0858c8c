#pragma once

#include "cli/console.h"
#include "cli/supervisor.h"

namespace roundabout::cli {

/// Says how a flight went and, with files, leaves metrics.json, report.html and the pictures in its
/// folder. True if the whole mission was flown and no bodies touched.
bool reportFlight(const FlightPlan& plan, const FlightResult& result, bool with_files,
                  Console& console);

}  // namespace roundabout::cli
