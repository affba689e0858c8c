#pragma once

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// How near bodies under way came to the experiment's obstacles.
ObstacleMetrics obstaclesOf(const Flight& flight);

}  // namespace roundabout::logs
