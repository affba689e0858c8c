#pragma once

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// How one vehicle moved and how its planner worked.
VehicleMetrics vehicleMetricsOf(const Flight& flight, const FlightVehicle& vehicle);

}  // namespace roundabout::logs
