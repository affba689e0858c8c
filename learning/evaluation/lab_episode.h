#pragma once

#include "learning/evaluation/episode.h"

namespace roundabout::learning {

/// As runEpisode(), in the lab of the simulator: multirotors, motion capture, and a planner's core
/// each, without the wires. Noise depends on rules.sim and the number of agents alone.
EpisodeResult runLabEpisode(const Rules& rules, const TestCase& test_case,
                            std::span<const std::unique_ptr<planner::Policy>> policies,
                            Trace* trace);

}  // namespace roundabout::learning
