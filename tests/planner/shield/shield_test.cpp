#include "planner/shield/shield.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/core/random.h"

namespace roundabout::planner::shield {
namespace {

using Eigen::Vector2d;

MotionBounds multirotor() {
  MotionBounds bounds;
  bounds.delay_s = 0.1;
  bounds.lag_s = 1.0 / 3.0;
  bounds.inner_lag_s = 0.15;
  bounds.max_acceleration_mps2 = 3.0;
  return bounds;
}

Ego egoAt(double x, double y, const MotionBounds& bounds = multirotor()) {
  Ego ego;
  ego.motion.position_world_m = {x, y};
  ego.bounds = bounds;
  ego.radius_m = 0.3;
  ego.goal_world_m = {10.0, 0.0};
  ego.id = 0;
  return ego;
}

Neighbour neighbourAt(double x, double y, int id = 1) {
  Neighbour other;
  other.motion.position_world_m = {x, y};
  other.bounds = multirotor();
  other.radius_m = 0.3;
  other.id = id;
  return other;
}

// How fast it may fly toward a neighbour in front of it.
double allowed(const Neighbour& other, const MotionBounds& bounds = multirotor()) {
  ShieldParameters parameters = ShieldParameters::lab();
  parameters.look_ahead_s = 0.0;
  Shield shield(parameters);
  const std::vector<Neighbour> others{other};
  return shield.decide(egoAt(0, 0, bounds), others, {}, {1.0, 0.0}, 0.0).velocity_world_mps.x();
}

TEST(Shield, ALoneVehicleFliesWhatItWantsBitForBit) {
  core::RandomStream random(1, "alone");
  for (const ShieldParameters& parameters :
       {ShieldParameters::idealRules(), ShieldParameters::lab()}) {
    for (int k = 0; k < 200; ++k) {
      Shield shield(parameters);
      Ego ego = egoAt(0, 0);
      for (int step = 0; step < 100; ++step) {
        const double angle = random.uniform(-1.2, 1.2);
        const Vector2d wanted(std::cos(angle), std::sin(angle));
        const ShieldDecision decision = shield.decide(ego, {}, {}, wanted, 0.1 * step);
        ASSERT_EQ(decision.velocity_world_mps, wanted);
        ASSERT_EQ(decision.layer, Layer::kNone);
        ego.motion.position_world_m += 0.1 * wanted;
        ego.goal_world_m.x() = ego.motion.position_world_m.x() + 10.0;
        ego.motion.velocity_world_mps = wanted;
      }
    }
  }
}

TEST(Shield, WhoeverIsFarAwayChangesNothing) { EXPECT_EQ(allowed(neighbourAt(8.0, 0.0)), 1.0); }

TEST(Shield, TakesHalfOfTheGapAndAllOfItToWhoIsParked) {
  const double half = allowed(neighbourAt(0.75, 0.0));
  Neighbour parked = neighbourAt(0.75, 0.0);
  parked.parked = true;
  EXPECT_GT(half, 0.1);
  EXPECT_LT(half, 0.9);
  EXPECT_NEAR(allowed(parked), 2.0 * half, 0.05);  // but for the overshoot
}

TEST(Shield, KeepsFartherFromWhoIsNotShieldedAndFliesAtIt) {
  Neighbour other = neighbourAt(1.2, 0.0);
  other.motion.velocity_world_mps = {-1.0, 0.0};
  const double trusted = allowed(other);
  other.shielded = false;
  EXPECT_LT(allowed(other), trusted - 0.1);
}

TEST(Shield, GetsOutOfTheWayOfWhoIsNotShielded) {
  Shield shield(ShieldParameters::lab());
  Neighbour other = neighbourAt(-2.0, 0.1);
  other.motion.velocity_world_mps = {1.0, 0.0};
  Ego ego = egoAt(0, 0);
  ego.parked = true;
  const auto flown = [&] {
    const std::vector<Neighbour> others{other};
    return shield.decide(ego, others, {}, {0.0, 0.0}, 0.0);
  };
  EXPECT_EQ(flown().velocity_world_mps, Vector2d(0.0, 0.0));
  other.shielded = false;
  EXPECT_LT(flown().velocity_world_mps.y(), -0.2) << "off its line, to the nearer side";
  EXPECT_EQ(flown().layer, Layer::kLookAhead);
  other.motion.velocity_world_mps = {-1.0, 0.0};
  EXPECT_EQ(flown().layer, Layer::kNone);
}

TEST(Shield, SeesWhereAnUnshieldedVehicleSpeedsUpTo) {
  Shield shield(ShieldParameters::lab());
  Neighbour other = neighbourAt(-1.2, 0.1);
  other.shielded = false;
  other.motion.velocity_world_mps = {0.1, 0.0};
  const auto speedAgainst = [&](const Vector2d& acceleration) {
    other.motion.drives.front().acceleration_mps2 = acceleration;
    const std::vector<Neighbour> others{other};
    return shield.decide(egoAt(0, 0), others, {}, {0.0, 0.0}, 0.0).velocity_world_mps.norm();
  };
  EXPECT_EQ(speedAgainst({0.0, 0.0}), 0.0);
  EXPECT_GT(speedAgainst({2.0, 0.0}), 0.3);
}

TEST(Shield, VehiclesAtOtherHeightsPass) {
  Neighbour other = neighbourAt(0.7, 0.0);
  other.motion.lowest_m = 1.0;
  other.motion.highest_m = 3.0;
  EXPECT_EQ(allowed(other), 1.0);
  other.motion.lowest_m = 0.4;  // it is to come down this far
  EXPECT_LT(allowed(other), 0.5);
}

TEST(Shield, VehiclesThatAnswerLaterBrakeEarlier) {
  ShieldParameters parameters = ShieldParameters::lab();
  parameters.look_ahead_s = 0.0;
  MotionBounds sluggish = multirotor();
  sluggish.delay_s = 0.2;
  sluggish.lag_s = 0.6;
  Neighbour parked = neighbourAt(1.15, 0.0);
  parked.parked = true;
  const std::vector<Neighbour> others{parked};
  const auto flown = [&](const MotionBounds& bounds) {
    Ego ego = egoAt(0, 0, bounds);
    ego.motion.velocity_world_mps = {0.6, 0.0};
    const std::vector<SentCommand> sent{{Vector2d(0.6, 0.0), 0.1, 0.2}};
    ego.motion.commands = sent;
    return Shield(parameters).decide(ego, others, {}, {1.0, 0.0}, 0.0).velocity_world_mps.x();
  };
  EXPECT_LT(flown(sluggish), flown(multirotor()) - 0.1);
}

TEST(Shield, SlidesAlongAWall) {
  Shield shield(ShieldParameters::lab());
  const std::vector<Wall> walls{{Vector2d(0.0, 1.0), 0.5}};
  const ShieldDecision decision =
      shield.decide(egoAt(0.0, 0.17), {}, {walls, {}}, Vector2d(0.5, 0.5), 0.0);
  EXPECT_EQ(decision.layer, Layer::kStatic);
  EXPECT_NEAR(decision.velocity_world_mps.x(), 0.5, 0.05);
  EXPECT_LT(decision.velocity_world_mps.y(), 0.05);
}

TEST(Shield, UnderIdealRulesACommandIsSlowedDownAndKeepsItsHeading) {
  Shield shield(ShieldParameters::idealRules());
  Ego ego = egoAt(0, 0, {});
  std::vector<Neighbour> others{neighbourAt(0.68, 0.05)};
  others.front().bounds = {};
  const Vector2d wanted(1.0, 0.1);
  const Vector2d flown = shield.decide(ego, others, {}, wanted, 0.0).velocity_world_mps;
  EXPECT_LT(flown.norm(), 0.9);
  EXPECT_NEAR(flown.x() * wanted.y() - flown.y() * wanted.x(), 0.0, 1e-12);
}

TEST(Shield, LooksAheadBeforeTheHardLayerHasTo) {
  Shield shield(ShieldParameters::lab());
  Ego ego = egoAt(0, 0);
  ego.motion.velocity_world_mps = {1.0, 0.0};
  std::vector<Neighbour> others{neighbourAt(2.2, 0.1)};
  others.front().motion.velocity_world_mps = {-1.0, 0.0};
  const ShieldDecision decision = shield.decide(ego, others, {}, {1.0, 0.0}, 0.0);
  EXPECT_EQ(decision.layer, Layer::kLookAhead);
  EXPECT_LT(decision.velocity_world_mps.y(), 0.0);
}

TEST(Shield, AParkedVehicleStepsAsideForWhoAsksAndReturns) {
  Shield shield(ShieldParameters::lab());
  Ego ego = egoAt(0, 0);
  ego.parked = true;
  ego.goal_world_m = {0, 0};
  std::vector<Neighbour> others{neighbourAt(-2.0, 0.1)};
  others.front().goal_world_m = {3.0, 0.1};
  EXPECT_EQ(shield.decide(ego, others, {}, {0, 0}, 0.0).layer, Layer::kNone);
  others.front().asks_for_way = true;
  const ShieldDecision decision = shield.decide(ego, others, {}, {0, 0}, 0.1);
  EXPECT_EQ(decision.layer, Layer::kStepAside);
  EXPECT_LT(decision.velocity_world_mps.y(), -0.2);
  others.front().motion.position_world_m.x() = 2.0;
  EXPECT_EQ(shield.decide(ego, others, {}, {0.3, 0.0}, 0.2).velocity_world_mps, Vector2d(0.3, 0.0));
}

TEST(Shield, BringsWhoDawdlesBeforeItsGoalAllTheWay) {
  Shield shield(ShieldParameters::lab());
  const std::vector<Neighbour> others{neighbourAt(0.0, 6.0)};
  Ego ego = egoAt(0, 0);
  ego.goal_world_m = {1.8, 0.0};
  bool taken_over = false;
  int steps = 0;
  for (; (ego.goal_world_m - ego.motion.position_world_m).norm() > 0.3 && steps < 80; ++steps) {
    const Vector2d across(0.0, steps % 20 < 10 ? 0.1 : -0.1);
    const ShieldDecision decision = shield.decide(ego, others, {}, across, 0.1 * steps);
    EXPECT_FALSE(taken_over && decision.layer == Layer::kNone) << steps;
    taken_over = taken_over || decision.layer == Layer::kBreaker;
    ego.motion.velocity_world_mps = decision.velocity_world_mps;
    ego.motion.position_world_m += 0.1 * decision.velocity_world_mps;
  }
  EXPECT_LT(steps, 60);
}

TEST(Shield, GoesStraightSoonAfterWhoBlockedItIsGone) {
  Shield shield(ShieldParameters::lab());
  const Ego ego = egoAt(0, 0);
  double now_s = 0.0;
  const auto decideFor = [&](double duration_s, const Neighbour& other) {
    const std::vector<Neighbour> others{other};
    ShieldDecision decision;
    for (const double end_s = now_s + duration_s; now_s < end_s; now_s += 0.1) {
      decision = shield.decide(ego, others, {}, {0.0, 0.0}, now_s);
    }
    return decision;
  };
  const ShieldDecision blocked = decideFor(8.0, neighbourAt(0.75, 0.0));
  EXPECT_EQ(blocked.layer, Layer::kBreaker);
  EXPECT_LT(blocked.velocity_world_mps.x(), 0.3);
  const ShieldDecision free = decideFor(0.8, neighbourAt(-6.0, 3.0));
  EXPECT_EQ(free.layer, Layer::kBreaker);
  EXPECT_GT(free.velocity_world_mps.x(), 0.9);
}

TEST(Shield, TheOrderOfNeighboursChangesNothing) {
  core::RandomStream random(3, "order");
  for (int k = 0; k < 100; ++k) {
    std::vector<Neighbour> others;
    for (int i = 1; i < 8; ++i) {
      others.push_back(neighbourAt(random.uniform(-2, 2), random.uniform(0.8, 2), i));
      others.back().motion.velocity_world_mps = {random.uniform(-1, 1), random.uniform(-1, 1)};
    }
    Shield first(ShieldParameters::lab());
    Shield second(ShieldParameters::lab());
    const Vector2d wanted(0.3, 0.9);
    const Vector2d flown = first.decide(egoAt(0, 0), others, {}, wanted, 0.0).velocity_world_mps;
    random.shuffle(others);
    EXPECT_LT(
        (second.decide(egoAt(0, 0), others, {}, wanted, 0.0).velocity_world_mps - flown).norm(),
        1e-6);
  }
}

}  // namespace
}  // namespace roundabout::planner::shield
