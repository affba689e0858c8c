#include "planner/shield/convex_gap.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/random.h"

namespace roundabout::planner::shield {
namespace {

using Eigen::Vector2d;

std::vector<Vector2d> randomPoints(core::RandomStream& random, const Vector2d& centre) {
  std::vector<Vector2d> points(1 + random.index(12));
  for (Vector2d& point : points) {
    point = centre + Vector2d(random.uniform(-1, 1), random.uniform(-1, 1));
  }
  return points;
}

// By trying all directions: the width of the widest empty strip.
double widest(Points first, Points second) {
  double best = -1e9;
  for (int i = 0; i < 20000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 20000;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    best = std::max(best, -extentAlong(second, -normal) - extentAlong(first, normal));
  }
  return best;
}

TEST(ConvexGap, IsTheWidestStripBetweenTheHulls) {
  core::RandomStream random(1, "gap");
  for (int k = 0; k < 200; ++k) {
    const std::vector<Vector2d> first = randomPoints(random, {0, 0});
    const std::vector<Vector2d> second =
        randomPoints(random, {random.uniform(-4, 4), random.uniform(-4, 4)});
    const double expected = widest(first, second);
    const ConvexGap gap = gapBetween(first, second);
    if (expected > 1e-3) {
      EXPECT_GE(gap.distance_m, expected - 1e-9);
      EXPECT_LE(gap.distance_m, expected + 1e-3);  // directions were tried in steps
    } else {
      EXPECT_LT(gap.distance_m, 2e-3);  // of hulls that overlap the sign alone matters
    }
    // Nothing of either is beyond the strip.
    const double along = -extentAlong(second, -gap.normal) - extentAlong(first, gap.normal);
    EXPECT_NEAR(along, gap.distance_m, 1e-9);
  }
}

TEST(ConvexGap, LooksTheSameFromBothSides) {
  core::RandomStream random(2, "gap");
  for (int k = 0; k < 500; ++k) {
    const std::vector<Vector2d> first = randomPoints(random, {0, 0});
    const std::vector<Vector2d> second = randomPoints(random, {3.0, random.uniform(-3, 3)});
    const ConvexGap there = gapBetween(first, second);
    const ConvexGap back = gapBetween(second, first);
    EXPECT_NEAR(there.distance_m, back.distance_m, 1e-9);
    EXPECT_LT((there.normal + back.normal).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace roundabout::planner::shield
