#pragma once

#include <string>

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// The verdict in one line: "5 of 5 formations formed, no bodies touched".
std::string headline(const Metrics& metrics);

/// "0.120 m, hex1 and hex4 at 34.2 s", or that there never was a pair in the air.
std::string describe(const ClosestGap& gap);

/// "planner of hex3 silent from 12.0 s to the end".
std::string describe(const Silence& silence);

/// A summary for a terminal: verdict, safety, a table of formations, one of vehicles, timing,
/// faults.
std::string toText(const Flight& flight, const Metrics& metrics);

}  // namespace roundabout::logs
