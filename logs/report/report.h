#pragma once

#include <string>

#include "logs/figures/figures.h"
#include "logs/flight.h"
#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// Writes one self-contained HTML page: verdict, pictures, tables, timing, faults and the
/// experiment. Needs the figures' files; loads nothing from anywhere when it is read.
/// command_line: how the flight was started, for the reader; may be empty. Throws
/// core::StartupError if a picture cannot be read or the page cannot be written.
void writeReport(const std::string& file, const Flight& flight, const Metrics& metrics,
                 const Figures& figures, const std::string& command_line);

}  // namespace roundabout::logs
