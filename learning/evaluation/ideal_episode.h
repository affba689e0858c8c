#pragma once

#include "learning/evaluation/episode.h"

namespace roundabout::learning {

/// As runEpisode(), with agents that do at once what they decide.
EpisodeResult runIdealEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew,
                              Trace* trace);

}  // namespace roundabout::learning
