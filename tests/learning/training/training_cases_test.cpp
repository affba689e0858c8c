#include "learning/training/training_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "learning/training/environment.h"
#include "learning/training/scores.h"

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

TEST(TrainingCases, OfFewAgentsComeMoreOftenIfTheExponentSaysSo) {
  core::RandomStream random(4, "cases");
  Crowd crowd;
  crowd.numbers_exponent = -1.0;
  std::array<double, 7> seen{};
  constexpr int kCases = 3000;
  for (int k = 0; k < kCases; ++k) {
    ++seen[drawTrainingCase(stage(2, 6), crowd, random).roles.size()];
  }
  const double harmonic = 1.0 / 2 + 1.0 / 3 + 1.0 / 4 + 1.0 / 5 + 1.0 / 6;
  for (std::size_t agents = 2; agents <= 6; ++agents) {
    const double expected = kCases / harmonic / static_cast<double>(agents);
    EXPECT_NEAR(seen[agents], expected, 5.0 * std::sqrt(expected)) << agents;
  }
}

/// Mean distance from start to goal in cases of six agents, m.
double meanWay(double published_square_share) {
  core::RandomStream random(5, "cases");
  Crowd crowd;
  crowd.published_square_share = published_square_share;
  double sum = 0.0;
  int agents = 0;
  for (int k = 0; k < 400; ++k) {
    for (const AgentSpec& agent : drawTrainingCase(stage(6, 6), crowd, random).test_case.agents) {
      sum += (agent.goal_m - agent.start_m).norm();
      ++agents;
    }
  }
  return sum / agents;
}

TEST(TrainingCases, AreNarrowerInThePublishedSquare) {
  EXPECT_LT(meanWay(1.0), 0.9 * meanWay(0.0));
}

TrainingCase caseOf(int agents) {
  core::RandomStream random(6, "cases");
  Crowd learners_only;
  learners_only.non_cooperative_share = learners_only.static_share = 0.0;
  return drawTrainingCase(stage(agents, agents), learners_only, random);
}

TEST(HardCases, AreDrawnOnceThereAreEnough) {
  HardCases hard;
  core::RandomStream random(7, "hard");
  EXPECT_FALSE(hard.worthDrawing());
  for (int k = 0; k < 40; ++k) {
    hard.add(caseOf(3));
  }
  ASSERT_TRUE(hard.worthDrawing());
  EXPECT_EQ(hard.draw(random).roles.size(), 3U);
  hard.clear();
  EXPECT_FALSE(hard.worthDrawing());
}

TEST(HardCases, ForgetTheOldest) {
  HardCases hard;
  core::RandomStream random(8, "hard");
  hard.add(caseOf(2));
  for (int k = 0; k < 2000; ++k) {
    hard.add(caseOf(3));
  }
  for (int k = 0; k < 20000; ++k) {
    ASSERT_EQ(hard.draw(random).roles.size(), 3U);
  }
}

/// Of environments that draw cases of two agents: those that begin with the hard case of five.
int begunWithAHardCase(double hard_share, const HardCases& hard) {
  Recipe recipe;
  Stage two = stage(2, 2);
  two.hard_share = hard_share;
  int begun = 0;
  for (int i = 0; i < 200; ++i) {
    Environment environment(recipe, core::RandomStream(9, "environment/" + std::to_string(i)),
                            &hard);
    environment.enter(two, -0.25);
    environment.beginSamples();
    Samples samples;
    environment.observe(samples);
    begun += samples.size() == 5 ? 1 : 0;
  }
  return begun;
}

TEST(HardCases, BeginTheShareOfEpisodesThatTheStageSays) {
  HardCases hard;
  EXPECT_EQ(begunWithAHardCase(0.5, hard), 0);
  for (int k = 0; k < 40; ++k) {
    hard.add(caseOf(5));
  }
  EXPECT_EQ(begunWithAHardCase(0.0, hard), 0);
  EXPECT_NEAR(begunWithAHardCase(0.5, hard), 100, 35);
}

TEST(HardCases, AreThoseInWhichALearnerFailed) {
  Recipe recipe;
  recipe.crowd.non_cooperative_share = recipe.crowd.static_share = 0.0;
  Stage crowded = stage(6, 6);
  crowded.hard_share = 0.5;
  Environment environment(recipe, core::RandomStream(10, "environment"));
  environment.enter(crowded, -0.25);
  environment.beginSamples();
  std::size_t failures = 0;
  std::size_t failed = 0;
  for (int step = 0; step < 3000; ++step) {
    Samples samples;
    environment.beginSamples();
    environment.observe(samples);
    // Scores of a learner that knows nothing.
    environment.choose(samples, Matrix::Zero(static_cast<Eigen::Index>(samples.size()), kHeads), 0);
    environment.step(samples);
    for (const EpisodeFigures& episode : environment.takeFinished()) {
      failures += episode.success ? 0U : 1U;
    }
    failed += environment.takeFailed().size();
  }
  EXPECT_GT(failures, 3U);
  EXPECT_EQ(failed, failures);
}

}  // namespace
}  // namespace roundabout::learning
