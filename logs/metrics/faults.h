#pragma once

#include "logs/metrics/metrics.h"

namespace roundabout::logs {

/// Who fell silent, what the operator ordered and what the fleet refused. Silence of planners and
/// fleet is counted in frames that they did not answer, so that a gap in the states is not held
/// against them.
FaultMetrics faultsOf(const Flight& flight, const std::vector<PhaseMetrics>& phases,
                      double nominal_interval_s);

}  // namespace roundabout::logs
