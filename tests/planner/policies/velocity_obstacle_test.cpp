#include "planner/linear_program/velocity_obstacle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/planner/policies/random_scene.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

constexpr double kHorizonS = 5.0;
constexpr double kStepS = 0.1;

struct Pair {
  Vector2d position_m;
  Vector2d velocity_mps;
  double radius_m;
};

Pair randomPair(core::RandomStream& random) {
  Pair pair;
  pair.position_m = randomVector(random, 4.0);
  pair.velocity_mps = randomVector(random, 2.0);
  pair.radius_m = random.uniform(0.4, 1.6);
  return pair;
}

std::optional<Escape> escapeOf(const Pair& pair) {
  return escapeFrom(pair.position_m, pair.velocity_mps, pair.radius_m, kHorizonS, kStepS);
}

bool overlap(const Pair& pair) { return pair.position_m.norm() <= pair.radius_m; }

// The definition: how near the discs' edges come to each other within the horizon; for discs that
// overlap, how near they are at the end of the step. Negative inside the velocity obstacle.
double closestGap(const Pair& pair, const Vector2d& relative_velocity) {
  double time = kStepS;
  if (!overlap(pair)) {
    const double speed_squared = relative_velocity.squaredNorm();
    const double nearest =
        speed_squared > 0.0 ? pair.position_m.dot(relative_velocity) / speed_squared : 0.0;
    time = std::clamp(nearest, 0.0, kHorizonS);
  }
  return (pair.position_m - time * relative_velocity).norm() - pair.radius_m;
}

TEST(VelocityObstacle, EscapeEndsOnItsEdge) {
  core::RandomStream random(1, "escape");
  for (int i = 0; i < 20000; ++i) {
    const Pair pair = randomPair(random);
    const auto escape = escapeOf(pair);
    ASSERT_TRUE(escape);
    EXPECT_NEAR(escape->normal.norm(), 1.0, 1e-12);
    const Vector2d on_edge = pair.velocity_mps + escape->depth_mps * escape->normal;
    EXPECT_NEAR(closestGap(pair, on_edge), 0.0, 1e-9) << "pair " << i;
  }
}

TEST(VelocityObstacle, DepthIsPositiveExactlyInside) {
  core::RandomStream random(2, "inside");
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Pair pair = randomPair(random);
    const bool collides = closestGap(pair, pair.velocity_mps) < 0.0;
    EXPECT_EQ(escapeOf(pair)->depth_mps > 0.0, collides) << "pair " << i;
    inside += collides ? 1 : 0;
  }
  EXPECT_GT(inside, 2000);
  EXPECT_LT(inside, 18000);
}

TEST(VelocityObstacle, NoShorterChangeReachesTheEdge) {
  core::RandomStream random(3, "shortest");
  for (int i = 0; i < 10000; ++i) {
    const Pair pair = randomPair(random);
    const Escape escape = *escapeOf(pair);
    const bool inside = escape.depth_mps > 0.0;
    for (int k = 0; k < 36; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / 36.0;
      const Vector2d shorter =
          0.999 * std::abs(escape.depth_mps) * Vector2d(std::cos(angle), std::sin(angle));
      EXPECT_EQ(closestGap(pair, pair.velocity_mps + shorter) < 0.0, inside) << "pair " << i;
    }
  }
}

TEST(VelocityObstacle, HeadOnBothEscapeToTheirRight) {
  const Escape mine = *escapeFrom({4.0, 0.0}, {2.0, 0.0}, 1.0, kHorizonS, kStepS);
  const Escape theirs = *escapeFrom({-4.0, 0.0}, {-2.0, 0.0}, 1.0, kHorizonS, kStepS);
  EXPECT_LT(mine.normal.y(), 0.0);
  EXPECT_EQ(theirs.normal, -mine.normal);
  EXPECT_EQ(theirs.depth_mps, mine.depth_mps);
}

TEST(VelocityObstacle, ApproachAtTheArcsCentreEscapesBackwards) {
  const Escape escape = *escapeFrom({4.0, 0.0}, {0.8, 0.0}, 1.0, kHorizonS, kStepS);
  EXPECT_EQ(escape.normal, Vector2d(-1.0, 0.0));
  EXPECT_DOUBLE_EQ(escape.depth_mps, 0.2);
}

TEST(VelocityObstacle, CoincidentDiscsComeApartAlongTheirRelativeVelocity) {
  const Escape escape = *escapeFrom({0.0, 0.0}, {0.0, 0.5}, 1.0, kHorizonS, kStepS);
  EXPECT_EQ(escape.normal, Vector2d(0.0, 1.0));
  EXPECT_DOUBLE_EQ(escape.depth_mps, 9.5);
}

TEST(VelocityObstacle, NoDirectionIsBetterIfPlaceAndVelocityCoincide) {
  EXPECT_FALSE(escapeFrom({0.0, 0.0}, {0.0, 0.0}, 1.0, kHorizonS, kStepS));
}

TEST(VelocityObstacle, StaysFiniteAtTheBorderOfOverlap) {
  for (const double distance : {1.0, std::nextafter(1.0, 0.0), std::nextafter(1.0, 2.0)}) {
    const Escape escape = *escapeFrom({distance, 0.0}, {1.0, 0.0}, 1.0, kHorizonS, kStepS);
    EXPECT_TRUE(escape.normal.allFinite());
    EXPECT_TRUE(std::isfinite(escape.depth_mps));
  }
}

}  // namespace
}  // namespace roundabout::planner
