#include "planner/observation.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/random.h"

namespace roundabout::planner {
namespace {

using core::EgoAgent;
using core::OtherAgent;
using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::Pointwise;

constexpr double kPi = std::numbers::pi;
constexpr float kTolerance = 1e-5F;

// At the origin, goal straight along world x, without a body: gaps are distances.
EgoAgent pointAgent() {
  EgoAgent ego;
  ego.goal_world_m = {10.0, 0.0};
  ego.radius_m = 0.0;
  return ego;
}

OtherAgent pointAt(double x_m, double y_m) {
  OtherAgent other;
  other.position_world_m = {x_m, y_m};
  other.radius_m = 0.0;
  return other;
}

// The parallel positions of the others, in the order in which they are fed.
std::vector<float> feed(const std::vector<OtherAgent>& others, int max_others = 19,
                        OthersOrder order = OthersOrder::kClosestLast) {
  ObservationEncoder encoder(max_others, order);
  std::vector<float> parallel_m;
  for (const OtherFeatures& features : encoder.encode(pointAgent(), others).others) {
    parallel_m.push_back(features[0]);
  }
  return parallel_m;
}

TEST(Observation, HasEveryFieldInItsPlace) {
  EgoAgent ego;
  ego.position_world_m = {1.0, 2.0};
  ego.goal_world_m = {1.0, 7.0};  // ego frame: x is world y, y is minus world x
  ego.heading_world_rad = 0.75 * kPi;
  ego.preferred_speed_mps = 1.25;
  ego.radius_m = 0.5;
  OtherAgent other;
  other.position_world_m = {-2.0, 6.0};
  other.velocity_world_mps = {0.5, -0.25};
  other.radius_m = 0.75;

  ObservationEncoder encoder(19, OthersOrder::kClosestLast);
  const std::vector<OtherAgent> others = {other};
  const Observation& observation = encoder.encode(ego, others);
  EXPECT_THAT(observation.ego, Pointwise(FloatNear(kTolerance),
                                         {5.0F, static_cast<float>(0.25 * kPi), 1.25F, 0.5F}));
  ASSERT_EQ(observation.others.size(), 1U);
  EXPECT_THAT(observation.others[0],
              Pointwise(FloatNear(kTolerance), {4.0F, 3.0F, -0.25F, -0.5F, 0.75F, 1.25F, 3.75F}));
}

TEST(Observation, HeadingIsPositiveWhenTheGoalLiesToTheRight) {
  EgoAgent ego = pointAgent();
  ego.heading_world_rad = 0.3;
  EXPECT_NEAR(ObservationEncoder(19, OthersOrder::kClosestLast).encode(ego, {}).ego[1], 0.3, 1e-6);
}

TEST(Observation, HeadingIsWrapped) {
  EgoAgent ego = pointAgent();
  ego.goal_world_m = {-1.0, -0.001};
  ego.heading_world_rad = kPi - 0.1;
  EXPECT_NEAR(ObservationEncoder(19, OthersOrder::kClosestLast).encode(ego, {}).ego[1],
              -0.1 - 0.001, 1e-6);
}

TEST(Observation, IsTheSameWhereverTheSceneLiesAndHoweverItIsTurned) {
  core::RandomStream random(1, "observation");
  for (int trial = 0; trial < 100; ++trial) {
    const auto vector = [&random] {
      const double x = random.uniform(-5.0, 5.0);
      return Eigen::Vector2d(x, random.uniform(-5.0, 5.0));
    };
    EgoAgent ego;
    ego.position_world_m = vector();
    ego.goal_world_m = vector();
    ego.heading_world_rad = random.uniform(-kPi, kPi);
    std::vector<OtherAgent> others(4);
    for (OtherAgent& other : others) {
      other.position_world_m = vector();
      other.velocity_world_mps = vector();
    }
    ObservationEncoder encoder(19, OthersOrder::kClosestLast);
    const Observation before = encoder.encode(ego, others);

    const double turn_rad = random.uniform(-kPi, kPi);
    const Eigen::Rotation2D<double> turn(turn_rad);
    const Eigen::Vector2d shift = vector();
    ego.position_world_m = turn * ego.position_world_m + shift;
    ego.goal_world_m = turn * ego.goal_world_m + shift;
    ego.heading_world_rad += turn_rad;
    for (OtherAgent& other : others) {
      other.position_world_m = turn * other.position_world_m + shift;
      other.velocity_world_mps = turn * other.velocity_world_mps;
    }
    const Observation& after = encoder.encode(ego, others);
    EXPECT_THAT(after.ego, Pointwise(FloatNear(kTolerance), before.ego));
    ASSERT_EQ(after.others.size(), before.others.size());
    for (std::size_t i = 0; i < after.others.size(); ++i) {
      EXPECT_THAT(after.others[i], Pointwise(FloatNear(kTolerance), before.others[i]));
    }
  }
}

TEST(Observation, TakesTheHeadingAsAxisWhenTheAgentIsAtItsGoal) {
  EgoAgent ego = pointAgent();
  ego.goal_world_m = ego.position_world_m;
  ego.heading_world_rad = 0.5 * kPi;
  ObservationEncoder encoder(19, OthersOrder::kClosestLast);
  const std::vector<OtherAgent> others = {pointAt(0.0, 2.0)};
  const Observation& observation = encoder.encode(ego, others);
  EXPECT_EQ(observation.ego[0], 0.0F);
  EXPECT_NEAR(observation.ego[1], 0.0, 1e-6);
  EXPECT_NEAR(observation.others[0][0], 2.0, 1e-6);
  EXPECT_NEAR(observation.others[0][1], 0.0, 1e-6);
}

TEST(ObservationOrder, IsClosestLast) {
  EXPECT_THAT(feed({pointAt(2.0, 0.0), pointAt(1.0, 0.0), pointAt(3.0, 0.0)}),
              ElementsAre(3.0F, 2.0F, 1.0F));
}

TEST(ObservationOrder, IsByGapNotByDistance) {
  OtherAgent large = pointAt(3.0, 0.0);
  large.radius_m = 2.5;
  EXPECT_THAT(feed({large, pointAt(1.0, 0.0)}), ElementsAre(1.0F, 3.0F));
}

TEST(ObservationOrder, PutsTheSmallerOrthogonalPositionFirstWhenGapsAreEqual) {
  EXPECT_THAT(feed({pointAt(0.6, 0.8), pointAt(1.0, 0.0), pointAt(0.8, -0.6)}),
              ElementsAre(0.8F, 1.0F, 0.6F));
}

TEST(ObservationOrder, TreatsGapsOfTheSameCentimetreAsEqual) {
  // 1.004 and 0.996 m both round to 1.00 m: the orthogonal position decides, not the distance.
  EXPECT_THAT(feed({pointAt(1.004, 0.0), pointAt(0.0, -0.996)}), ElementsAre(0.0F, 1.004F));
  EXPECT_THAT(feed({pointAt(1.006, 0.0), pointAt(0.0, -0.996)}), ElementsAre(1.006F, 0.0F));
}

TEST(ObservationOrder, RoundsHalvesAsPythonDoes) {
  // 0.125 and 0.375 are exact halves and go to the even neighbour. The binary numbers 0.155 and
  // 0.415 lie below the half and 0.165 and 0.445 above it, though 100 times each is a half exactly.
  struct Case {
    double gap_m;
    double rounded_m;
  };
  for (const Case each : {Case{0.125, 0.12}, Case{0.375, 0.38}, Case{0.155, 0.15},
                          Case{0.415, 0.41}, Case{0.165, 0.17}, Case{0.445, 0.45}}) {
    // The other one's gap is the rounded one: equal gaps put it first, for it lies to the right.
    EXPECT_THAT(feed({pointAt(each.gap_m, 0.0), pointAt(0.0, -each.rounded_m)}),
                ElementsAre(0.0F, static_cast<float>(each.gap_m)))
        << each.gap_m;
    EXPECT_THAT(feed({pointAt(each.gap_m, 0.0), pointAt(0.0, -each.rounded_m + 0.01)}),
                ElementsAre(static_cast<float>(each.gap_m), 0.0F))
        << each.gap_m;
  }
}

TEST(ObservationOrder, KeepsTheGivenOrderOfFullTies) {
  OtherAgent first = pointAt(1.0, 0.0);
  first.radius_m = 0.25;
  OtherAgent second = pointAt(1.25, 0.0);
  second.radius_m = 0.5;
  EXPECT_THAT(feed({first, second}), ElementsAre(1.0F, 1.25F));
  EXPECT_THAT(feed({second, first}), ElementsAre(1.25F, 1.0F));
}

TEST(ObservationOrder, KeepsTheClosestWhenThereAreTooMany) {
  std::vector<OtherAgent> others;
  for (int i = 0; i < 25; ++i) {
    others.push_back(pointAt(1.0 + (i * 7) % 25, 0.0));
  }
  const std::vector<float> fed = feed(others);
  ASSERT_EQ(fed.size(), 19U);
  EXPECT_EQ(fed.front(), 19.0F);
  EXPECT_EQ(fed.back(), 1.0F);
}

TEST(ObservationOrder, PrefersTheSmallerOrthogonalPositionWhenNotAllFit) {
  EXPECT_THAT(feed({pointAt(0.6, 0.8), pointAt(0.8, -0.6), pointAt(1.0, 0.0)}, 2),
              ElementsAre(0.8F, 1.0F));
}

OtherAgent movingFrom(double x_m, double y_m, double vx_mps, double vy_mps) {
  OtherAgent other = pointAt(x_m, y_m);
  other.velocity_world_mps = {vx_mps, vy_mps};
  other.radius_m = 0.5;
  return other;
}

TEST(ClosestFirst, FeedsTheClosestFirst) {
  EXPECT_THAT(feed({pointAt(2.0, 0.0), pointAt(1.0, 0.0), pointAt(3.0, 0.0)}, 19,
                   OthersOrder::kClosestFirst),
              ElementsAre(1.0F, 2.0F, 3.0F));
}

TEST(ClosestFirst, PutsTheSmallerOrthogonalPositionFirstOfEqualGapsAsWell) {
  EXPECT_THAT(feed({pointAt(0.6, 0.8), pointAt(1.0, 0.0), pointAt(0.8, -0.6)}, 19,
                   OthersOrder::kClosestFirst),
              ElementsAre(0.8F, 1.0F, 0.6F));
}

TEST(ClosestFirst, KeepsTheClosestWhenThereAreTooMany) {
  EXPECT_THAT(feed({pointAt(3.0, 0.0), pointAt(2.0, 0.0), pointAt(1.0, 0.0)}, 2,
                   OthersOrder::kClosestFirst),
              ElementsAre(1.0F, 2.0F));
}

// The ego stands, so times to collision are the others' ways over their speeds.
TEST(TimeToCollision, FeedsTheFirstCollisionLast) {
  const OtherAgent near_but_slow = movingFrom(2.5, 0.0, -0.5, 0.0);  // touches after 4 s
  const OtherAgent far_but_fast = movingFrom(0.0, 4.5, 0.0, -2.0);   // after 2 s
  const OtherAgent leaving = movingFrom(1.5, 0.0, 1.0, 0.0);         // never
  EXPECT_THAT(feed({near_but_slow, far_but_fast, leaving}, 19, OthersOrder::kTimeToCollision),
              ElementsAre(1.5F, 2.5F, 0.0F));
}

TEST(TimeToCollision, IsOfRelativeVelocities) {
  EgoAgent ego = pointAgent();
  ego.velocity_world_mps = {1.0, 0.0};
  // Ahead and standing, ahead and as fast: the first is run into though it is farther away.
  const std::vector<OtherAgent> others = {movingFrom(6.0, 0.0, 0.0, 0.0),
                                          movingFrom(2.0, 0.0, 1.0, 0.0)};
  ObservationEncoder encoder(19, OthersOrder::kTimeToCollision);
  const Observation& observation = encoder.encode(ego, others);
  EXPECT_EQ(observation.others[0][0], 2.0F);
  EXPECT_EQ(observation.others[1][0], 6.0F);
}

TEST(TimeToCollision, IsNoneWhenBodiesPassEachOther) {
  // Radius 0.5 m: one that aims 0.51 m past the ego never touches, one that aims 0.49 m past does.
  EXPECT_THAT(feed({movingFrom(3.0, 0.49, -1.0, 0.0), movingFrom(2.0, 0.51, -1.0, 0.0)}, 19,
                   OthersOrder::kTimeToCollision),
              ElementsAre(2.0F, 3.0F));
}

TEST(TimeToCollision, IsZeroForBodiesThatOverlap) {
  EXPECT_THAT(feed({movingFrom(0.25, 0.0, 1.0, 0.0), movingFrom(0.5625, 0.0, -1.0, 0.0)}, 19,
                   OthersOrder::kTimeToCollision),
              ElementsAre(0.5625F, 0.25F));
}

TEST(TimeToCollision, BreaksTiesByGapAndThenByOrthogonalPosition) {
  // Nobody moves: all times are infinite.
  EXPECT_THAT(feed({pointAt(2.0, 0.0), pointAt(1.0, 0.0), pointAt(3.0, 0.0)}, 19,
                   OthersOrder::kTimeToCollision),
              ElementsAre(3.0F, 2.0F, 1.0F));
  EXPECT_THAT(feed({pointAt(0.6, 0.8), pointAt(1.0, 0.0), pointAt(0.8, -0.6)}, 19,
                   OthersOrder::kTimeToCollision),
              ElementsAre(0.8F, 1.0F, 0.6F));
}

TEST(TimeToCollision, KeepsWhoCollidesFirstWhenThereAreTooMany) {
  EXPECT_THAT(feed({movingFrom(1.0, 3.0, 0.0, 0.0), movingFrom(9.5, 0.0, -1.0, 0.0),
                    movingFrom(5.5, 0.0, -0.1, 0.0)},
                   2, OthersOrder::kTimeToCollision),
              ElementsAre(5.5F, 9.5F));
}

TEST(OthersOrder, IsTheSameHoweverTheOthersAreGiven) {
  core::RandomStream random(2, "orders");
  for (const NamedOthersOrder& each : kOthersOrders) {
    SCOPED_TRACE(each.name);
    ObservationEncoder encoder(7, each.order);
    for (int trial = 0; trial < 100; ++trial) {
      EgoAgent ego = pointAgent();
      ego.velocity_world_mps = {random.uniform(-1.0, 1.0), 0.5};
      std::vector<OtherAgent> others;
      for (int i = 0; i < 12; ++i) {
        const double x_m = random.uniform(-4.0, 4.0);
        const double y_m = random.uniform(-4.0, 4.0);
        const double vx_mps = random.uniform(-1.0, 1.0);
        others.push_back(movingFrom(x_m, y_m, vx_mps, random.uniform(-1.0, 1.0)));
      }
      const Observation before = encoder.encode(ego, others);
      random.shuffle(others);
      EXPECT_EQ(encoder.encode(ego, others).others, before.others);
    }
  }
}

TEST(OthersOrder, HasAName) {
  for (const NamedOthersOrder& each : kOthersOrders) {
    EXPECT_EQ(nameOf(each.order), each.name);
    EXPECT_EQ(othersOrderNamed(each.name), each.order);
  }
  EXPECT_EQ(othersOrderNamed("closest"), std::nullopt);
}

}  // namespace
}  // namespace roundabout::planner
