#include "learning/evaluation/episode.h"

#include <gtest/gtest.h>

#include "planner/policies/table.h"

namespace roundabout::learning {
namespace {

using Policies = std::vector<std::unique_ptr<planner::Policy>>;

Policies crew(const std::vector<std::string>& names, const Rules& rules) {
  Policies policies;
  for (const std::string& name : names) {
    planner::PolicyOptions options;
    options.orca = rules.orca;
    policies.push_back(planner::makePolicy(name, options));
  }
  return policies;
}

EpisodeResult run(const TestCase& test_case, const std::vector<std::string>& names,
                  const std::string& rules_name = "published", Trace* trace = nullptr) {
  const Rules rules = makeRules(rules_name);
  const Policies policies = crew(names, rules);
  return runEpisode(rules, test_case, {.policies = policies}, trace);
}

AgentSpec agent(double x, double goal_x, double y = 0.0) { return {{x, y}, {goal_x, y}, 0.5, 1.0}; }

TEST(IdealEpisode, AloneItTakesTheStraightLineTimeRoundedUpToSteps) {
  const EpisodeResult result = run({{agent(0.0, 5.05)}, {}}, {"non_cooperative"});
  EXPECT_EQ(result.outcome, Outcome::kAllAtGoal);
  EXPECT_EQ(result.steps, 49);  // 4.85 m at 0.1 m a step
  EXPECT_NEAR(result.mean_extra_time_s, 0.05, 1e-9);
  EXPECT_EQ(result.decisions, 49);
}

TEST(IdealEpisode, WhoStandsGetsStuckAfterEightTimesThat) {
  const EpisodeResult result = run({{agent(0.0, 1.2)}, {}}, {"static"});
  EXPECT_EQ(result.outcome, Outcome::kStuck);
  EXPECT_NEAR(result.steps, 80, 1);
  EXPECT_TRUE(std::isnan(result.mean_extra_time_s));
}

TEST(IdealEpisode, ACollisionEndsBothAndTheCase) {
  Trace trace;
  const EpisodeResult result =
      run({{agent(0.0, 6.0), agent(6.0, 0.0), agent(0.0, 6.05, 9.0)}, {}},
          {"non_cooperative", "non_cooperative", "non_cooperative"}, "published", &trace);
  EXPECT_EQ(result.outcome, Outcome::kCollision);
  EXPECT_EQ(result.steps, 59) << "the third goes on to its goal";
  EXPECT_LE(result.closest_separation_m, 0.0);
  EXPECT_TRUE(trace.back().back()[0].collided);
  EXPECT_FALSE(trace.back().back()[2].collided);
  EXPECT_EQ(trace.back().back()[0].position_m, trace[0][40][0].position_m) << "who collided stands";
  EXPECT_NEAR(result.mean_extra_time_s, 0.0, 0.1) << "of the one that arrived";
}

TEST(IdealEpisode, WhoHasArrivedCanBeHitAndKeepsItsArrival) {
  // The first arrives at x = 0.8; the second is driven through that place.
  const EpisodeResult result =
      run({{agent(0.0, 1.0), agent(8.0, -8.0)}, {}}, {"non_cooperative", "non_cooperative"});
  EXPECT_EQ(result.outcome, Outcome::kCollision);
  EXPECT_NEAR(result.mean_extra_time_s, 0.0, 0.1);
}

TEST(IdealEpisode, LaterGoalsAreFlownToFromWhereOneIs) {
  TestCase each{{agent(0.0, 3.25)}, {{{6.25, 0.0}}}};
  Trace trace;
  const EpisodeResult result = run(each, {"non_cooperative"}, "published", &trace);
  EXPECT_EQ(result.outcome, Outcome::kAllAtGoal);
  EXPECT_EQ(result.steps, 61);
  EXPECT_NEAR(trace.back().back()[0].position_m.x(), 6.1, 1e-9);
}

const core::Polygon kBox{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};

TEST(IdealEpisode, WhoFliesIntoAnObstacleHasCollided) {
  const TestCase each{{agent(-3.0, 3.0)}, {}, {kBox}};
  Trace trace;
  const EpisodeResult result = run(each, {"non_cooperative"}, "published", &trace);
  EXPECT_EQ(result.outcome, Outcome::kCollision);
  EXPECT_NEAR(trace.back().back()[0].position_m.x(), -1.0, 0.1) << "its edge at the box";
  EXPECT_LE(result.closest_separation_m, 0.0);
}

TEST(IdealEpisode, OrcaIsToldOfObstaclesAndGoesRound) {
  const TestCase each{{agent(-3.0, 3.0)}, {}, {kBox}};
  Policies policies;
  policies.push_back(planner::makePolicy("orca", {}));  // leans to the right
  const EpisodeResult result = runEpisode(makeRules("published"), each, {.policies = policies});
  EXPECT_EQ(result.outcome, Outcome::kAllAtGoal);
  EXPECT_GT(result.closest_separation_m, 0.0);
  EXPECT_LT(result.closest_separation_m, 1.0);
}

TEST(LabEpisode, ObstaclesAreAvoidedByOrcaAndCountAsCollisionsWhenTouched) {
  const EpisodeResult clear = run({{agent(-3.0, 3.0)}, {}, {kBox}}, {"orca"}, "lab");
  EXPECT_EQ(clear.outcome, Outcome::kAllAtGoal);
  const TestCase start_in_it{{agent(-0.7, 3.0)}, {}, {kBox}};
  EXPECT_EQ(run(start_in_it, {"orca"}, "lab").outcome, Outcome::kCollision);
}

TEST(LabEpisode, OrcaCrossesWithoutTouching) {
  const TestCase each{{agent(-3.0, 3.0), {{0.0, -3.0}, {0.0, 3.0}, 0.5, 1.0}}, {}};
  const EpisodeResult result = run(each, {"orca", "orca"}, "lab");
  EXPECT_EQ(result.outcome, Outcome::kAllAtGoal);
  EXPECT_GT(result.mean_extra_time_s, 0.3) << "lag, and slowing down near the goal";
  EXPECT_LT(result.mean_extra_time_s, 20.0);
}

TEST(LabEpisode, BodiesThatMeetHeadOnCollide) {
  const EpisodeResult result = run({{agent(-3.0, 3.0), agent(3.0, -3.0)}, {}},
                                   {"non_cooperative", "non_cooperative"}, "lab");
  EXPECT_EQ(result.outcome, Outcome::kCollision);
}

TEST(LabEpisode, BodiesThatTouchAfterBothHaveArrivedCollideToo) {
  // Two goals side by side, closer than the bodies; a third is under way all the time.
  const TestCase each{{agent(-2.0, 0.0, 0.30), agent(2.0, 0.0, -0.30), agent(-4.0, 9.0, 9.0)}, {}};
  const EpisodeResult result =
      run(each, {"non_cooperative", "non_cooperative", "non_cooperative"}, "lab");
  EXPECT_EQ(result.outcome, Outcome::kCollision);
}

TEST(LabEpisode, IsRepeatedExactly) {
  const TestCase each{{agent(-3.0, 3.0), {{0.0, -3.0}, {0.0, 3.0}, 0.5, 1.0}}, {}};
  const EpisodeResult first = run(each, {"orca", "orca"}, "lab");
  const EpisodeResult second = run(each, {"orca", "orca"}, "lab");
  EXPECT_EQ(first.closest_separation_m, second.closest_separation_m);
  EXPECT_EQ(first.steps, second.steps);
}

}  // namespace
}  // namespace roundabout::learning
