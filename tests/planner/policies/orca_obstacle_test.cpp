// ORCA beside obstacles that stand: the geometry of one half-plane, and whole flights.

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "common/core/polygon.h"
#include "planner/policies/orca/obstacle.h"
#include "planner/policies/orca/orca.h"
#include "tests/planner/policies/ideal_flight.h"
#include "tests/planner/policies/random_scene.h"

namespace roundabout::planner {
namespace {

using core::Polygon;
using Eigen::Vector2d;

// Round a centre, so that no corner turns right.
Polygon randomConvex(core::RandomStream& random, const Vector2d& centre_m) {
  const std::size_t count = 3 + random.index(5);
  const double radius_m = random.uniform(0.1, 3.0);
  std::vector<double> angles;
  for (std::size_t i = 0; i < count; ++i) {
    angles.push_back(random.uniform(-std::numbers::pi, std::numbers::pi));
  }
  std::sort(angles.begin(), angles.end());
  Polygon polygon;
  for (const double angle : angles) {
    polygon.push_back(centre_m + radius_m * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

// How near the disc's centre comes to the obstacle within the horizon at this velocity. The
// distance to a convex set on a straight way is a convex function of time: golden sections find
// its least value.
double nearestWithin(const Polygon& obstacle, const Vector2d& velocity, double horizon_s) {
  constexpr double kRatio = 0.6180339887498949;
  double begin_s = 0.0;
  double end_s = horizon_s;
  const auto distance = [&](double time_s) {
    return core::distanceTo(obstacle, velocity * time_s);
  };
  double left_s = end_s - kRatio * (end_s - begin_s);
  double right_s = begin_s + kRatio * (end_s - begin_s);
  double left_m = distance(left_s);
  double right_m = distance(right_s);
  for (int i = 0; i < 60; ++i) {
    if (left_m < right_m) {
      end_s = right_s;
      right_s = left_s;
      right_m = left_m;
      left_s = end_s - kRatio * (end_s - begin_s);
      left_m = distance(left_s);
    } else {
      begin_s = left_s;
      left_s = right_s;
      left_m = right_m;
      right_s = begin_s + kRatio * (end_s - begin_s);
      right_m = distance(right_s);
    }
  }
  return std::min(left_m, right_m);
}

struct Case {
  Polygon obstacle;
  DiscMotion disc;
};

Case randomCase(core::RandomStream& random) {
  return {randomConvex(random, randomVector(random, 4.0)),
          {.velocity_mps = randomVector(random, 1.2),
           .radius_m = random.uniform(0.1, 2.0),
           .max_speed_mps = 1.2 * std::numbers::sqrt2,
           .horizon_s = random.uniform(0.5, 5.0)}};
}

TEST(OrcaObstacle, WhatIsAllowedDoesNotTouchWithinTheHorizon) {
  core::RandomStream random(1, "allowed");
  int constrained = 0;
  for (int i = 0; i < 10000; ++i) {
    SCOPED_TRACE(i);
    const Case each = randomCase(random);
    const std::optional<HalfPlane> half_plane = halfPlaneBeside(each.obstacle, each.disc);
    if (core::distanceTo(each.obstacle, Vector2d::Zero()) <= each.disc.radius_m) {
      continue;
    }
    constrained += half_plane ? 1 : 0;
    for (int k = 0; k < 10; ++k) {
      Vector2d velocity = randomVector(random, 1.2);
      if (half_plane) {
        // On the edge and beyond it.
        velocity += std::max(0.0, -half_plane->margin(velocity)) * half_plane->normal;
      }
      if (velocity.norm() <= each.disc.max_speed_mps) {
        ASSERT_GE(nearestWithin(each.obstacle, velocity, each.disc.horizon_s),
                  each.disc.radius_m - 1e-6);
      }
    }
  }
  EXPECT_GT(constrained, 3000);
}

TEST(OrcaObstacle, ZeroVelocityIsAlwaysAllowed) {
  core::RandomStream random(2, "zero");
  for (int i = 0; i < 10000; ++i) {
    const Case each = randomCase(random);
    const auto half_plane = halfPlaneBeside(each.obstacle, each.disc);
    if (half_plane) {
      ASSERT_GE(half_plane->margin(Vector2d::Zero()), 0.0) << i;
      ASSERT_NEAR(half_plane->normal.norm(), 1.0, 1e-12) << i;
    }
  }
}

// The velocity obstacle, asked point by point.
bool touches(const Case& each, const Vector2d& velocity) {
  return nearestWithin(each.obstacle, velocity, each.disc.horizon_s) < each.disc.radius_m;
}

// Distance from the disc's velocity to the edge of the velocity obstacle along a ray.
double edgeAlong(const Case& each, double angle_rad, double reach_mps) {
  const Vector2d ray(std::cos(angle_rad), std::sin(angle_rad));
  const bool inside = touches(each, each.disc.velocity_mps);
  // From outside the obstacle may be entered and left: look for the first change in steps.
  const double step = reach_mps / 60.0;
  for (double at = step; at <= reach_mps; at += step) {
    if (touches(each, each.disc.velocity_mps + at * ray) != inside) {
      double low = at - step;
      double high = at;
      for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (touches(each, each.disc.velocity_mps + middle * ray) == inside ? low : high) = middle;
      }
      return high;
    }
  }
  return std::numeric_limits<double>::infinity();
}

TEST(OrcaObstacle, EdgeGoesThroughTheNearestPointOfTheVelocityObstacle) {
  core::RandomStream random(3, "nearest");
  int compared = 0;
  while (compared < 200) {
    const Case each = randomCase(random);
    const auto half_plane = halfPlaneBeside(each.obstacle, each.disc);
    if (!half_plane ||
        core::distanceTo(each.obstacle, Vector2d::Zero()) <= each.disc.radius_m + 1e-3) {
      continue;
    }
    const double depth_mps = std::abs(half_plane->margin(each.disc.velocity_mps));
    if (depth_mps > 1.5 || depth_mps < 1e-3) {
      continue;
    }
    ++compared;
    SCOPED_TRACE(compared);
    // There is the edge where the half-plane says, and nowhere nearer.
    const Vector2d towards = half_plane->margin(each.disc.velocity_mps) < 0.0
                                 ? half_plane->normal
                                 : Vector2d(-half_plane->normal);
    const double angle_rad = std::atan2(towards.y(), towards.x());
    EXPECT_NEAR(edgeAlong(each, angle_rad, 1.5 * depth_mps), depth_mps, 1e-4);
    for (int k = 0; k < 48; ++k) {
      EXPECT_GE(edgeAlong(each, angle_rad + k * std::numbers::pi / 24.0, depth_mps),
                depth_mps - 1e-4);
    }
  }
}

TEST(OrcaObstacle, BesideAWallLimitsTheSpeedTowardsItOnly) {
  // A wall 2 m ahead that reaches far to both sides; radius 0.5 m, horizon 3 s.
  const Polygon wall = {{2.0, -50.0}, {3.0, -50.0}, {3.0, 50.0}, {2.0, 50.0}};
  const DiscMotion disc{
      .velocity_mps = {1.0, 0.3}, .radius_m = 0.5, .max_speed_mps = 1.5, .horizon_s = 3.0};
  const auto half_plane = halfPlaneBeside(wall, disc);
  ASSERT_TRUE(half_plane);
  EXPECT_NEAR((half_plane->normal - Vector2d(-1.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(half_plane->offset_mps, -0.5, 1e-12);
}

TEST(OrcaObstacle, PassesASymmetricOneOnTheRight) {
  const Polygon box = {{3.0, -0.2}, {3.4, -0.2}, {3.4, 0.2}, {3.0, 0.2}};
  const auto half_plane = halfPlaneBeside(
      box, {.velocity_mps = {1.0, 0.0}, .radius_m = 0.3, .max_speed_mps = 1.0, .horizon_s = 5.0});
  ASSERT_TRUE(half_plane);
  EXPECT_LT(half_plane->normal.y(), -0.9);
}

TEST(OrcaObstacle, OutOfReachForbidsNothing) {
  const Polygon box = {{9.0, -0.2}, {9.4, -0.2}, {9.4, 0.2}, {9.0, 0.2}};
  EXPECT_FALSE(halfPlaneBeside(
      box, {.velocity_mps = {1.0, 0.0}, .radius_m = 0.5, .max_speed_mps = 1.0, .horizon_s = 5.0}));
}

TEST(OrcaObstacle, WhoTouchesMayNotComeNearer) {
  const Polygon box = {{0.3, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {0.3, 1.0}};
  const DiscMotion disc{
      .velocity_mps = {1.0, 0.0}, .radius_m = 0.5, .max_speed_mps = 1.0, .horizon_s = 2.0};
  const auto half_plane = halfPlaneBeside(box, disc);
  ASSERT_TRUE(half_plane);
  EXPECT_EQ(half_plane->offset_mps, 0.0);
  EXPECT_NEAR((half_plane->normal - Vector2d(-1.0, 0.0)).norm(), 0.0, 1e-12);

  // Inside: the shortest way out is allowed.
  const Polygon around = {{-0.1, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-0.1, 1.0}};
  EXPECT_NEAR((halfPlaneBeside(around, disc)->normal - Vector2d(-1.0, 0.0)).norm(), 0.0, 1e-12);
}

Polygon rectangle(double min_x, double min_y, double max_x, double max_y) {
  return {{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
}

core::EgoAgent agent(const Vector2d& start, const Vector2d& goal) {
  core::EgoAgent ego;
  ego.position_world_m = start;
  ego.goal_world_m = goal;
  ego.preferred_speed_mps = 0.5;
  return ego;
}

class OrcaAmongObstacles : public ::testing::Test {
 protected:
  void add(const Vector2d& start, const Vector2d& goal) {
    flight_.add(agent(start, goal), makeOrca({}));
  }

  IdealFlight flight_;
};

TEST_F(OrcaAmongObstacles, GoesRoundABoxBetweenItAndItsGoal) {
  flight_.obstacles = {rectangle(-0.5, -0.5, 0.5, 0.5)};
  add({-4.0, 0.0}, {4.0, 0.0});
  flight_.flyFor(60.0);
  EXPECT_TRUE(flight_.allArrived());
  EXPECT_GT(flight_.closestObstacle(), 0.0);
}

TEST_F(OrcaAmongObstacles, GoesThroughACorridorThatFits) {
  flight_.obstacles = {rectangle(-3.0, 0.6, 3.0, 3.0), rectangle(-3.0, -3.0, 3.0, -0.6)};
  add({-5.0, 1.5}, {5.0, 0.0});
  flight_.flyFor(60.0);
  EXPECT_TRUE(flight_.allArrived());
  EXPECT_GT(flight_.closestObstacle(), 0.0);
}

TEST_F(OrcaAmongObstacles, StopsBeforeAWallAndDoesNotTouchIt) {
  flight_.obstacles = {rectangle(0.0, -20.0, 0.2, 20.0)};
  add({-3.0, 0.0}, {3.0, 0.0});
  flight_.flyFor(120.0);
  EXPECT_FALSE(flight_.allArrived());
  EXPECT_GT(flight_.closestObstacle(), 0.0);
}

// An L: its outer corners are convex, the one in its notch is not.
const Polygon kAngle = {{0.0, 0.0}, {3.0, 0.0}, {3.0, 3.0}, {2.0, 3.0}, {2.0, 1.0}, {0.0, 1.0}};

TEST_F(OrcaAmongObstacles, PassesTheConvexCornersOfAnObstacleThatIsNotConvex) {
  flight_.obstacles = {kAngle};
  add({5.0, -2.0}, {2.0, 4.5});
  add({5.0, 5.0}, {-1.0, -1.5});
  add({-2.0, -1.0}, {4.0, 1.0});
  flight_.flyFor(120.0);
  EXPECT_TRUE(flight_.allArrived());
  EXPECT_GT(flight_.closestObstacle(), 0.0);
  EXPECT_GT(flight_.closestGap(), 0.0);
}

TEST_F(OrcaAmongObstacles, StopsInANotchAndTouchesNoSideOfIt) {
  flight_.obstacles = {kAngle};
  add({-2.0, 3.5}, {4.0, -1.0});
  flight_.flyFor(120.0);
  EXPECT_FALSE(flight_.allArrived());
  EXPECT_GT(flight_.closestObstacle(), 0.0);
}

TEST(OrcaObstacles, FromInsideOneThatIsNotConvexNobodyGoesDeeper) {
  core::RandomStream random(5, "inside");
  const std::vector<Polygon> obstacles = {kAngle};
  int inside = 0;
  int wanted_deeper = 0;
  for (int i = 0; i < 2000; ++i) {
    core::EgoAgent ego = randomScene(random, 0, 4.0).ego;
    ego.radius_m = 0.1;
    if (core::distanceTo(kAngle, ego.position_world_m) >= -1e-6) {
      continue;
    }
    ++inside;
    const Vector2d way_out =
        core::nearestOnOutline(kAngle, ego.position_world_m) - ego.position_world_m;
    wanted_deeper += way_out.dot(ego.goal_world_m - ego.position_world_m) < 0.0 ? 1 : 0;
    core::Surroundings around;
    around.obstacles = obstacles;
    const Decision decision = makeOrca({})->decide(ego, around);
    const double direction_rad = ego.heading_world_rad + decision.heading_change_rad;
    const Vector2d velocity =
        decision.speed_mps * Vector2d(std::cos(direction_rad), std::sin(direction_rad));
    EXPECT_GE(velocity.dot(way_out.normalized()), -1e-9) << i;
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(wanted_deeper, 50);
}

TEST_F(OrcaAmongObstacles, ComesOutOfOneThatIsNotConvexTheShortestWay) {
  flight_.obstacles = {kAngle};
  add({2.2, 2.0}, {-1.0, 2.0});  // to the notch's side
  add({0.5, 0.3}, {0.5, -2.0});  // through the foot
  add({2.2, 0.8}, {0.5, 2.5});   // by the corner in the notch
  flight_.flyFor(60.0);
  EXPECT_TRUE(flight_.allArrived());
}

TEST_F(OrcaAmongObstacles, IsNotPushedIntoAWallByACrowd) {
  flight_.obstacles = {rectangle(-6.0, -2.0, 6.0, -0.6), rectangle(-6.0, 2.0, 6.0, 4.0)};
  add({0.0, 0.0}, {0.0, 0.0});
  for (const double y_m : {-0.05, 1.4}) {
    for (const double x_m : {-4.0, 4.0}) {
      add({x_m, y_m}, {-x_m, y_m});
    }
  }
  flight_.flyFor(60.0);
  EXPECT_GT(flight_.closestObstacle(), 0.0);
}

TEST(OrcaObstacles, HoldWhenNeighboursLeaveNoSolution) {
  // A wall right behind, three who come: giving way ends at the wall.
  core::EgoAgent ego = agent({0.0, 0.0}, {0.0, 0.0});
  std::vector<core::OtherAgent> others;
  for (const double x_m : {-0.7, 0.0, 0.7}) {
    others.push_back({{x_m, 1.1}, {-x_m, -2.0}, 0.5});
  }
  core::Surroundings around(others);
  const std::vector<Polygon> walls = {rectangle(-5.0, -2.0, 5.0, -0.53)};
  EXPECT_GT(makeOrca({})->decide(ego, around).speed_mps, 0.1);
  around.obstacles = walls;
  const Decision decision = makeOrca({})->decide(ego, around);
  const double direction_rad = ego.heading_world_rad + decision.heading_change_rad;
  // 5 mm are free beyond the inflated radius, within 2 s.
  EXPECT_GE(decision.speed_mps * std::sin(direction_rad), -0.0025 - 1e-9);
}

TEST_F(OrcaAmongObstacles, NobodyTouchesAnythingInACrowd) {
  core::RandomStream random(4, "crowds");
  int flown = 0;
  while (flown < 200) {
    IdealFlight flight;
    for (int k = 0; k < 4; ++k) {
      flight.obstacles.push_back(randomConvex(random, randomVector(random, 4.0)));
    }
    std::vector<core::EgoAgent> agents;
    for (int trial = 0; trial < 100 && agents.size() < 5; ++trial) {
      const core::EgoAgent candidate = randomScene(random, 0, 5.0).ego;
      const bool free = std::all_of(flight.obstacles.begin(), flight.obstacles.end(),
                                    [&](const Polygon& each) {
                                      return core::distanceTo(each, candidate.position_world_m) >
                                             1.05 * candidate.radius_m;
                                    }) &&
                        std::all_of(agents.begin(), agents.end(), [&](const core::EgoAgent& each) {
                          return (each.position_world_m - candidate.position_world_m).norm() >
                                 1.05 * (each.radius_m + candidate.radius_m);
                        });
      if (free) {
        agents.push_back(candidate);
      }
    }
    for (const core::EgoAgent& each : agents) {
      flight.add(each, makeOrca({}));
    }
    flight.flyFor(40.0);
    EXPECT_GT(flight.closestObstacle(), 0.0) << "flight " << flown;
    ++flown;
  }
}

}  // namespace
}  // namespace roundabout::planner
