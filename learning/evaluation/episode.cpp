#include "learning/evaluation/episode.h"

#include "learning/evaluation/ideal_episode.h"
#include "learning/evaluation/lab_episode.h"

namespace roundabout::learning {

const char* nameOf(Outcome outcome) {
  switch (outcome) {
    case Outcome::kAllAtGoal:
      return "all_at_goal";
    case Outcome::kCollision:
      return "collision";
    case Outcome::kStuck:
      return "stuck";
  }
  return "";
}

EpisodeResult runEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew,
                         Trace* trace) {
  for (const auto& policy : crew.policies) {
    policy->reset();
  }
  return rules.lab ? runLabEpisode(rules, test_case, crew, trace)
                   : runIdealEpisode(rules, test_case, crew, trace);
}

}  // namespace roundabout::learning
