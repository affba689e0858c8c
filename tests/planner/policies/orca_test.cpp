#include "planner/policies/orca/orca.h"

#include <numbers>

#include <gtest/gtest.h>

#include "planner/policies/static/static.h"
#include "tests/planner/policies/ideal_flight.h"
#include "tests/planner/policies/random_scene.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

core::EgoAgent agent(const Vector2d& start, const Vector2d& goal) {
  core::EgoAgent ego;
  ego.position_world_m = start;
  ego.goal_world_m = goal;
  ego.preferred_speed_mps = 0.5;
  return ego;
}

void addTwoHeadOn(IdealFlight& flight, const PolicyOptions& options) {
  flight.add(agent({-4.0, 0.0}, {4.0, 0.0}), makeOrca(options));
  flight.add(agent({4.0, 0.0}, {-4.0, 0.0}), makeOrca(options));
}

void addFourThroughOnePoint(IdealFlight& flight, const PolicyOptions& options) {
  addTwoHeadOn(flight, options);
  flight.add(agent({0.0, -4.0}, {0.0, 4.0}), makeOrca(options));
  flight.add(agent({0.0, 4.0}, {0.0, -4.0}), makeOrca(options));
}

void expectArrivalWithin(double duration_s, IdealFlight& flight) {
  flight.flyFor(duration_s);
  EXPECT_TRUE(flight.allArrived());
  EXPECT_GT(flight.closestGap(), 0.0);
}

TEST(OrcaFlight, TwoSwapPlacesHeadOn) {
  IdealFlight flight;
  addTwoHeadOn(flight, {});
  expectArrivalWithin(20.0, flight);
}

TEST(OrcaFlight, FourGoThroughOnePoint) {
  IdealFlight flight;
  addFourThroughOnePoint(flight, {});
  expectArrivalWithin(20.0, flight);
}

TEST(OrcaFlight, WithoutRightBiasFourBlockEachOtherInOnePoint) {
  PolicyOptions options;
  options.orca.right_bias_rad = 0.0;
  IdealFlight flight;
  addFourThroughOnePoint(flight, options);
  flight.flyFor(60.0);
  EXPECT_FALSE(flight.allArrived());
  EXPECT_GT(flight.closestGap(), 0.0);
}

TEST(OrcaFlight, FlowsRoundOneThatStands) {
  IdealFlight flight;
  flight.add(agent({-3.0, 0.0}, {3.0, 0.0}), makeOrca({}));
  flight.add(agent({0.0, 0.0}, {0.0, 0.0}), makeStatic({}));
  expectArrivalWithin(20.0, flight);
}

// Anywhere, with any speed and radius.
core::EgoAgent randomAgent(core::RandomStream& random) { return randomScene(random, 0, 4.0).ego; }

bool apart(const core::EgoAgent& a, const core::EgoAgent& b) {
  const double distance = 1.05 * (a.radius_m + b.radius_m) + 0.1;
  return (a.position_world_m - b.position_world_m).norm() > distance &&
         (a.goal_world_m - b.goal_world_m).norm() > distance;
}

TEST(OrcaFlight, RandomPairsArriveWithoutCollision) {
  core::RandomStream random(1, "pairs");
  int flown = 0;
  while (flown < 1000) {
    const core::EgoAgent a = randomAgent(random);
    const core::EgoAgent b = randomAgent(random);
    if (!apart(a, b)) {
      continue;
    }
    IdealFlight flight;
    flight.add(a, makeOrca({}));
    flight.add(b, makeOrca({}));
    flight.flyFor(120.0);
    EXPECT_TRUE(flight.allArrived()) << "pair " << flown;
    EXPECT_GT(flight.closestGap(), 0.0) << "pair " << flown;
    ++flown;
  }
}

TEST(Orca, AloneFliesStraightAtPreferredSpeed) {
  core::EgoAgent ego = agent({1.0, 1.0}, {1.0, 5.0});
  ego.preferred_speed_mps = 0.7;
  const Decision decision = makeOrca({})->decide(ego, {});
  EXPECT_NEAR(decision.speed_mps, 0.7, 1e-9);
  EXPECT_NEAR(decision.heading_change_rad, std::numbers::pi / 2.0, 1e-9);
  EXPECT_EQ(decision.neighbours_used, 0);
}

TEST(Orca, DoesNotOvershootTheGoal) {
  const Decision decision = makeOrca({})->decide(agent({0.0, 0.0}, {0.03, 0.0}), {});
  EXPECT_NEAR(decision.speed_mps, 0.3, 1e-9);
}

TEST(Orca, StandsOnTheGoalAndKeepsItsHeading) {
  core::EgoAgent ego = agent({2.0, 2.0}, {2.0, 2.0});
  ego.heading_world_rad = 1.0;
  const Decision decision = makeOrca({})->decide(ego, {});
  EXPECT_EQ(decision.speed_mps, 0.0);
  EXPECT_EQ(decision.heading_change_rad, 0.0);
}

TEST(Orca, TakesHalfOfTheChangeThatIsNeeded) {
  PolicyOptions options;
  options.orca.radius_factor = 1.0;
  options.orca.right_bias_rad = 0.0;
  const core::OtherAgent ahead{{4.0, 0.0}, {0.0, 0.0}, 0.5};
  const Decision decision =
      makeOrca(options)->decide(agent({0.0, 0.0}, {9.0, 0.0}), std::span(&ahead, 1));
  // 3 m are free, for both together and for the horizon of 5 s.
  EXPECT_NEAR(decision.speed_mps, 0.3, 1e-9);
  EXPECT_NEAR(decision.heading_change_rad, 0.0, 1e-9);
}

TEST(Orca, LeansToTheRightOnlyWhereItCannotGoStraight) {
  const core::EgoAgent ego = agent({0.0, 0.0}, {9.0, 0.0});
  const core::OtherAgent ahead{{4.0, 0.0}, {0.0, 0.0}, 0.5};
  EXPECT_LT(makeOrca({})->decide(ego, std::span(&ahead, 1)).heading_change_rad, -0.1);
  const core::OtherAgent aside{{4.0, 8.0}, {0.0, 0.0}, 0.5};
  EXPECT_NEAR(makeOrca({})->decide(ego, std::span(&aside, 1)).heading_change_rad, 0.0, 1e-9);
}

TEST(Orca, TurnsInPlaceWhereTheTurnIsSharperThanTheLimit) {
  PolicyOptions options;
  options.orca.max_heading_change_rad = 0.5;
  core::EgoAgent ego = agent({0.0, 0.0}, {-1.0, 1.0});
  Decision decision = makeOrca(options)->decide(ego, {});
  EXPECT_EQ(decision.speed_mps, 0.0);
  EXPECT_DOUBLE_EQ(decision.heading_change_rad, 0.5);

  ego.goal_world_m = {-1.0, -1.0};
  decision = makeOrca(options)->decide(ego, {});
  EXPECT_EQ(decision.speed_mps, 0.0);
  EXPECT_DOUBLE_EQ(decision.heading_change_rad, -0.5);
}

TEST(Orca, BodiesThatOverlapComeApart) {
  const core::EgoAgent ego = agent({0.0, 0.0}, {5.0, 0.0});
  const core::OtherAgent ahead{{0.6, 0.0}, {0.0, 0.0}, 0.5};
  const Decision decision = makeOrca({})->decide(ego, std::span(&ahead, 1));
  EXPECT_NEAR(decision.speed_mps, ego.preferred_speed_mps, 1e-9);
  EXPECT_NEAR(std::abs(decision.heading_change_rad), std::numbers::pi, 1e-9);
}

TEST(Orca, LooksAtTheNearestOnly) {
  core::RandomStream random(2, "nearest");
  const PolicyOptions options;
  const std::size_t limit = static_cast<std::size_t>(options.orca.max_neighbours);
  const Scene scene = randomScene(random, limit, 4.0);
  // Nearer in time than anybody in the square, but farther away.
  std::vector<core::OtherAgent> bullets;
  for (int i = 0; i < 10; ++i) {
    const Vector2d ahead(20.0 + i, 0.0);
    bullets.push_back({scene.ego.position_world_m + ahead, -10.0 * ahead, 0.5});
  }
  std::vector<core::OtherAgent> crowd = bullets;
  crowd.insert(crowd.end(), scene.others.begin(), scene.others.end());
  const Decision expected = makeOrca(options)->decide(scene.ego, scene.others);
  const Decision decision = makeOrca(options)->decide(scene.ego, crowd);
  EXPECT_EQ(decision.speed_mps, expected.speed_mps);
  EXPECT_EQ(decision.heading_change_rad, expected.heading_change_rad);
  EXPECT_EQ(decision.neighbours_used, options.orca.max_neighbours);

  const Decision alone = makeOrca(options)->decide(scene.ego, {});
  const Decision threatened = makeOrca(options)->decide(scene.ego, bullets);
  EXPECT_NE(threatened.heading_change_rad, alone.heading_change_rad);
}

TEST(OrcaFlight, KeepsTheInflatedRadiusClear) {
  for (const double factor : {1.0, 1.5}) {
    PolicyOptions options;
    options.orca.radius_factor = factor;
    options.orca.right_bias_rad = 0.0;
    IdealFlight flight;
    flight.add(agent({-4.0, 0.0}, {4.0, 0.0}), makeOrca(options));
    flight.add(agent({0.0, -4.0}, {0.0, 4.0}), makeOrca(options));
    flight.flyFor(40.0);
    EXPECT_TRUE(flight.allArrived());
    EXPECT_NEAR(flight.closestGap(), factor - 1.0, 0.05) << "factor " << factor;
  }
}

}  // namespace
}  // namespace roundabout::planner
