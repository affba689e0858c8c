#pragma once

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// How near bodies that did not rest came to the experiment's obstacles.
ObstacleMetrics obstaclesOf(const Flight& flight);

}  // namespace roundabout::logs
