#pragma once

#include "logs/flight.h"
#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// Vehicles and people by the simulator's own truth, the way between two of its messages straight.
/// Empty for a flight without PEDESTRIAN_TRUTH.
PeopleMetrics peopleOf(const Flight& flight);

}  // namespace roundabout::logs
