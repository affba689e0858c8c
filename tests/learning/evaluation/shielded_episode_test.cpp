// What the shield promises under the published rules and those of the lab.

#include <gtest/gtest.h>

#include "learning/evaluation/episode.h"
#include "learning/evaluation/generate.h"
#include "learning/evaluation/suites.h"
#include "planner/policies/table.h"

namespace roundabout::learning {
namespace {

EpisodeResult fly(const TestCase& test_case, const std::string& policy, bool shielded,
                  const Rules& rules = makeRules("published")) {
  planner::PolicyOptions options;
  options.orca = rules.orca;
  std::vector<std::unique_ptr<planner::Policy>> policies;
  for (std::size_t i = 0; i < test_case.agents.size(); ++i) {
    policies.push_back(planner::makePolicy(policy, options));
  }
  const std::vector<std::uint8_t> shields(policies.size(), shielded ? 1 : 0);
  return runEpisode(rules, test_case, {policies, shields});
}

TEST(ShieldedEpisode, ExactlySymmetricSwapsOfTwoToThirtyArrive) {
  const Suite swaps = makeSuite("swaps");
  for (const std::string policy : {"orca", "non_cooperative"}) {
    for (const TestCase& each : swaps.groups.front().cases) {
      const EpisodeResult result = fly(each, policy, true);
      EXPECT_EQ(result.outcome, Outcome::kAllAtGoal) << policy << " " << each.agents.size();
      EXPECT_GE(result.closest_separation_m, 0.004) << policy << " " << each.agents.size();
    }
  }
}

TEST(ShieldedEpisode, DenseCirclesArrive) {
  for (const auto& [agents, radius_m] :
       {std::pair{5, 4.0}, {6, 5.0}, {10, 5.0}, {20, 10.0}, {30, 15.0}}) {
    EXPECT_EQ(fly(circleCase(agents, radius_m), "orca", true).outcome, Outcome::kAllAtGoal)
        << agents;
  }
}

TEST(ShieldedEpisode, NobodyCollidesHoweverStraightTheyFly) {
  GeneratorSettings settings;
  for (const int agents : {4, 8}) {
    settings.agents = agents;
    for (const TestCase& each : generateCases("mixed", settings, 50, 7)) {
      EXPECT_NE(fly(each, "non_cooperative", true).outcome, Outcome::kCollision);
    }
  }
}

TEST(ShieldedEpisode, ALoneAgentFliesTheSameWithAndWithout) {
  GeneratorSettings settings;
  settings.agents = 1;
  settings.force_interaction = false;
  for (const TestCase& each : generateCases("random", settings, 200, 3)) {
    for (const std::string policy : {"orca", "non_cooperative"}) {
      const EpisodeResult with = fly(each, policy, true);
      const EpisodeResult without = fly(each, policy, false);
      EXPECT_EQ(with.steps, without.steps);
      EXPECT_EQ(with.mean_extra_time_s, without.mean_extra_time_s);
      EXPECT_EQ(with.layers[0], with.decisions);
    }
  }
}

TEST(ShieldedEpisode, NobodyCollidesInTheLabWithSlowVehiclesAndLostMessages) {
  Rules rules = makeRules("lab");
  rules.loss = 0.2;
  slowDown(rules, 1.5);
  GeneratorSettings settings;
  settings.agents = 6;
  for (const std::string policy : {"orca", "non_cooperative"}) {
    for (const TestCase& each : generateCases("mixed", settings, 8, 4)) {
      EXPECT_EQ(fly(each, policy, true, rules).outcome, Outcome::kAllAtGoal) << policy;
    }
  }
}

TEST(ShieldedEpisode, SomebodyCollidesInTheLabWithoutIt) {
  GeneratorSettings settings;
  settings.agents = 6;
  int collisions = 0;
  for (const TestCase& each : generateCases("mixed", settings, 8, 4)) {
    const EpisodeResult result = fly(each, "non_cooperative", false, makeRules("lab"));
    collisions += result.outcome == Outcome::kCollision ? 1 : 0;
  }
  EXPECT_GT(collisions, 4);
}

}  // namespace
}  // namespace roundabout::learning
