#pragma once

#include <vector>

#include "logs/metrics/metrics.h"
#include "logs/metrics/separation.h"

namespace roundabout::logs {

/// What the fleet was doing when, from its statuses.
std::vector<PhaseMetrics> phasesOf(const Flight& flight);

/// Every formation that the fleet went for, in order of time; touches and approaches are counted
/// from the flight's encounters.
std::vector<FormationMetrics> formationsOf(const Flight& flight,
                                           const std::vector<PhaseMetrics>& phases,
                                           const GapsOverTime& gaps,
                                           const SeparationMetrics& separation);

}  // namespace roundabout::logs
