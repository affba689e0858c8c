#pragma once

#include "learning/evaluation/episode.h"

namespace roundabout::learning {

/// As runEpisode(), in the lab of the simulator: multirotors, motion capture, and a planner's core
/// each, without the wires. Noise depends on rules.sim and the number of agents alone.
EpisodeResult runLabEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew,
                            Trace* trace);

}  // namespace roundabout::learning
