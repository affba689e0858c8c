#pragma once

#include <cstddef>

#include "logs/flight.h"

namespace roundabout::logs {

/// m, horizontal, over the tracked samples [begin, end): along points at least 1 cm apart, so that
/// the noise of a hovering vehicle adds nothing.
double pathLength(const FlightVehicle& vehicle, std::size_t begin, std::size_t end);

/// m/s, the largest published velocity while in the air.
double maxSpeed(const Flight& flight, const FlightVehicle& vehicle);

/// m/s^2, the largest change of the published velocity over 0.2 s while in the air.
double maxAcceleration(const Flight& flight, const FlightVehicle& vehicle);

}  // namespace roundabout::logs
