#include "learning/training/training_cases.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace roundabout::learning {
namespace {

Stage stage(int min_agents, int max_agents) {
  Stage stage;
  stage.min_agents = min_agents;
  stage.max_agents = max_agents;
  return stage;
}

TEST(TrainingCases, HaveAsManyAgentsAsTheStageSaysAndAlwaysALearner) {
  core::RandomStream random(1, "cases");
  Stage crowded = stage(2, 6);
  crowded.trap_share = 0.3;
  Crowd crowd;
  crowd.non_cooperative_share = 0.45;
  crowd.static_share = 0.45;
  std::array<int, 7> seen{};
  for (int k = 0; k < 500; ++k) {
    const TrainingCase drawn = drawTrainingCase(crowded, crowd, random);
    ASSERT_EQ(drawn.roles.size(), drawn.test_case.agents.size());
    ASSERT_GE(drawn.roles.size(), 2U);
    ASSERT_LE(drawn.roles.size(), 6U);
    ++seen[drawn.roles.size()];
    EXPECT_TRUE(std::any_of(drawn.roles.begin(), drawn.roles.end(), isLearner));
  }
  EXPECT_TRUE(std::all_of(seen.begin() + 2, seen.end(), [](int count) { return count > 50; }));
}

TEST(TrainingCases, PutNobodyWhoStandsOnTheGoalOfAnother) {
  core::RandomStream random(2, "cases");
  Crowd crowd;
  crowd.static_share = 0.5;
  int standing = 0;
  for (int k = 0; k < 200; ++k) {
    const TrainingCase drawn = drawTrainingCase(stage(4, 8), crowd, random);
    const auto& agents = drawn.test_case.agents;
    for (std::size_t i = 0; i < agents.size(); ++i) {
      if (drawn.roles[i] != Role::kStatic) {
        continue;
      }
      ++standing;
      for (std::size_t j = 0; j < agents.size(); ++j) {
        if (j != i) {
          EXPECT_GE((agents[i].start_m - agents[j].goal_m).norm(),
                    agents[i].radius_m + agents[j].radius_m);
        }
      }
    }
  }
  EXPECT_GT(standing, 100);
}

TEST(TrainingCases, TrapsAreOneOrTwoLearnersAmongOthersThatHaveParked) {
  core::RandomStream random(3, "cases");
  Stage traps = stage(5, 10);
  traps.trap_share = 1.0;
  Crowd learners_only;
  learners_only.non_cooperative_share = learners_only.static_share = 0.0;
  int count = 0;
  for (int k = 0; k < 100; ++k) {
    const TrainingCase drawn = drawTrainingCase(traps, learners_only, random);
    const auto learners = std::count_if(drawn.roles.begin(), drawn.roles.end(), isLearner);
    if (learners == static_cast<std::ptrdiff_t>(drawn.roles.size())) {
      continue;  // no trap came of many draws
    }
    ++count;
    EXPECT_LE(learners, 2);
    for (std::size_t i = 0; i < drawn.roles.size(); ++i) {
      if (!isLearner(drawn.roles[i])) {
        EXPECT_EQ(drawn.test_case.agents[i].start_m, drawn.test_case.agents[i].goal_m);
      }
    }
  }
  EXPECT_GE(count, 90);
}

}  // namespace
}  // namespace roundabout::learning
