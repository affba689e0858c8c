#pragma once

#include "learning/evaluation/episode.h"

namespace roundabout::learning {

/// As runEpisode(), with agents that do at once what they decide.
EpisodeResult runIdealEpisode(const Rules& rules, const TestCase& test_case,
                              std::span<const std::unique_ptr<planner::Policy>> policies,
                              Trace* trace);

}  // namespace roundabout::learning
