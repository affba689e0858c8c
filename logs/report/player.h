#pragma once

#include <string>

#include "logs/flight.h"
#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// The part of the report that plays the flight: map, slider, separation, modes and events over
/// time, as HTML with its own script and data; loads nothing. Empty for a flight without frames.
/// The address may end in #t=12.5: where to begin, s since the first frame.
std::string playerHtml(const Flight& flight, const Metrics& metrics);

}  // namespace roundabout::logs
