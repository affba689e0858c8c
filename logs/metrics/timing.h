#pragma once

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

TimingMetrics timingOf(const Flight& flight);

}  // namespace roundabout::logs
