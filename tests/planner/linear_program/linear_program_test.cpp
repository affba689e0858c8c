#include "planner/linear_program/linear_program.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include <gtest/gtest.h>

#include "planner/linear_program/velocity_obstacle.h"
#include "planner/policies/orca/obstacle.h"
#include "tests/planner/policies/random_scene.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

struct Problem {
  std::vector<HalfPlane> half_planes;
  Vector2d preferred_mps;
  double max_speed_mps;
  std::size_t hard = 0;  // so many half-planes, the first ones, are never given up
};

// As agents pose it: the smaller the square, the more crowded.
Problem crowdProblem(core::RandomStream& random, double half_side_m) {
  const Scene scene = randomScene(random, 1 + random.index(8), half_side_m);
  Problem problem;
  for (const core::OtherAgent& other : scene.others) {
    const auto escape = escapeFrom(other.position_world_m - scene.ego.position_world_m,
                                   scene.ego.velocity_world_mps - other.velocity_world_mps,
                                   scene.ego.radius_m + other.radius_m, 5.0, 0.1);
    const double offset =
        escape->normal.dot(scene.ego.velocity_world_mps) + 0.5 * escape->depth_mps;
    problem.half_planes.push_back({escape->normal, offset});
  }
  problem.preferred_mps = randomVector(random, scene.ego.preferred_speed_mps);
  problem.max_speed_mps = scene.ego.preferred_speed_mps;
  return problem;
}

// Any directions, edges through the disc or near it: feasible and infeasible about equally often.
Problem arbitraryProblem(core::RandomStream& random) {
  Problem problem;
  const std::size_t count = 1 + random.index(8);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
    problem.half_planes.push_back({{std::cos(angle), std::sin(angle)}, random.uniform(-1.2, 0.8)});
  }
  problem.preferred_mps = randomVector(random, 1.5);
  problem.max_speed_mps = 1.0;
  return problem;
}

// As agents among obstacles pose it.
Problem obstructedProblem(core::RandomStream& random, double half_side_m) {
  const Scene scene = randomScene(random, 0, half_side_m);
  Problem problem;
  const std::size_t obstacles = 1 + random.index(4);
  for (std::size_t i = 0; i < obstacles; ++i) {
    const Vector2d corner = randomVector(random, half_side_m);
    const std::vector<Vector2d> triangle = {corner,
                                            corner + Vector2d(random.uniform(0.1, 4.0), 0.0),
                                            corner + Vector2d(0.0, random.uniform(0.1, 4.0))};
    const auto half_plane =
        halfPlaneBeside(triangle, {scene.ego.velocity_world_mps, scene.ego.radius_m, 2.0, 2.0});
    if (half_plane) {
      problem.half_planes.push_back(*half_plane);
    }
  }
  problem.hard = problem.half_planes.size();
  const Problem crowd = crowdProblem(random, half_side_m);
  problem.half_planes.insert(problem.half_planes.end(), crowd.half_planes.begin(),
                             crowd.half_planes.end());
  problem.preferred_mps = crowd.preferred_mps;
  problem.max_speed_mps = crowd.max_speed_mps;
  return problem;
}

double worstViolation(std::span<const HalfPlane> half_planes, const Vector2d& velocity) {
  double worst = 0.0;
  for (const HalfPlane& half_plane : half_planes) {
    worst = std::max(worst, -half_plane.margin(velocity));
  }
  return worst;
}

std::span<const HalfPlane> hardOnes(const Problem& problem) {
  return std::span(problem.half_planes).first(problem.hard);
}

std::span<const HalfPlane> softOnes(const Problem& problem) {
  return std::span(problem.half_planes).subspan(problem.hard);
}

// The point where a . v = p and b . v = q, if there is one.
void addCrossing(const Vector2d& a, double p, const Vector2d& b, double q,
                 std::vector<Vector2d>& points) {
  const double determinant = a.x() * b.y() - a.y() * b.x();
  if (std::abs(determinant) > 1e-9) {
    points.emplace_back((p * b.y() - q * a.y()) / determinant,
                        (q * a.x() - p * b.x()) / determinant);
  }
}

// The nearest point to zero of the line a . v = p, and where the line crosses the circle.
void addLine(const Vector2d& a, double p, double max_speed, std::vector<Vector2d>& points) {
  const double length = a.norm();
  if (length < 1e-9 || std::abs(p) > max_speed * length) {
    return;
  }
  const Vector2d foot = a * (p / (length * length));
  const Vector2d along =
      Vector2d(-a.y(), a.x()) / length * std::sqrt(max_speed * max_speed - foot.squaredNorm());
  points.insert(points.end(), {foot, foot + along, foot - along});
}

// Every point that can be the optimum of the plane program: an optimum lies at the preferred
// velocity, nearest to it on one edge, or in a corner of two edges or of an edge and the circle.
std::vector<Vector2d> candidatesForNearest(const Problem& problem) {
  const Vector2d& preferred = problem.preferred_mps;
  std::vector<Vector2d> points = {preferred};
  points.push_back(preferred * std::min(1.0, problem.max_speed_mps / preferred.norm()));
  for (const HalfPlane& a : problem.half_planes) {
    points.push_back(preferred - a.margin(preferred) * a.normal);
    addLine(a.normal, a.offset_mps, problem.max_speed_mps, points);
    for (const HalfPlane& b : problem.half_planes) {
      addCrossing(a.normal, a.offset_mps, b.normal, b.offset_mps, points);
    }
  }
  return points;
}

// Every point that can have the least violation: deepest on the circle for one half-plane, or where
// two of these meet: the circle, the edge of a hard one, a line where two others are equally bad.
std::vector<Vector2d> candidatesForLeastViolation(const Problem& problem) {
  struct Line {
    Vector2d normal;
    double offset;
  };
  std::vector<Line> lines;
  for (const HalfPlane& hard : hardOnes(problem)) {
    lines.push_back({hard.normal, hard.offset_mps});
  }
  const auto soft = softOnes(problem);
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < soft.size(); ++i) {
    points.push_back(soft[i].normal * problem.max_speed_mps);
    for (std::size_t j = 0; j < i; ++j) {
      lines.push_back({soft[i].normal - soft[j].normal, soft[i].offset_mps - soft[j].offset_mps});
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    addLine(lines[i].normal, lines[i].offset, problem.max_speed_mps, points);
    for (std::size_t j = 0; j < i; ++j) {
      addCrossing(lines[i].normal, lines[i].offset, lines[j].normal, lines[j].offset, points);
    }
  }
  return points;
}

double leastViolation(const Problem& problem) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vector2d& point : candidatesForLeastViolation(problem)) {
    if (point.norm() <= problem.max_speed_mps + 1e-12 &&
        worstViolation(hardOnes(problem), point) < 1e-9) {
      least = std::min(least, worstViolation(softOnes(problem), point));
    }
  }
  return least;
}

// Infinite if no candidate keeps every half-plane.
double nearestDistance(const Problem& problem) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector2d& point : candidatesForNearest(problem)) {
    if (point.norm() <= problem.max_speed_mps + 1e-9 &&
        worstViolation(problem.half_planes, point) < 1e-9) {
      nearest = std::min(nearest, (point - problem.preferred_mps).norm());
    }
  }
  return nearest;
}

struct Tally {
  int feasible = 0;
  int infeasible = 0;
};

// Compares the program with the enumeration of all candidates.
void check(const Problem& problem, LinearProgram& program, Tally& tally) {
  const VelocityChoice choice = program.solve(problem.half_planes, problem.preferred_mps,
                                              problem.max_speed_mps, problem.hard);
  ASSERT_LE(choice.velocity_mps.norm(), problem.max_speed_mps + 1e-9);
  ASSERT_LE(worstViolation(hardOnes(problem), choice.velocity_mps), 1e-9);
  ASSERT_NEAR(worstViolation(softOnes(problem), choice.velocity_mps), choice.violation_mps, 1e-9);
  const double nearest = nearestDistance(problem);
  if (std::isfinite(nearest)) {
    ++tally.feasible;
    ASSERT_LE(choice.violation_mps, 1e-9);
    // Near a needle-sharp corner 1e-9 m/s of violation buys more than that of distance.
    ASSERT_NEAR((choice.velocity_mps - problem.preferred_mps).norm(), nearest, 1e-6);
  } else {
    ++tally.infeasible;
    ASSERT_GT(choice.violation_mps, 0.0);
    ASSERT_NEAR(choice.violation_mps, leastViolation(problem), 1e-9);
  }
}

TEST(LinearProgram, SolvesWhatAgentsPose) {
  core::RandomStream random(1, "crowds");
  LinearProgram program;
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    ASSERT_NO_FATAL_FAILURE(check(crowdProblem(random, 1.0 + i % 6), program, tally));
  }
  EXPECT_GT(tally.feasible, 5000);
  EXPECT_GT(tally.infeasible, 5000);
}

TEST(LinearProgram, SolvesWhatAgentsPoseAmongObstacles) {
  core::RandomStream random(4, "obstacles");
  LinearProgram program;
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    ASSERT_NO_FATAL_FAILURE(check(obstructedProblem(random, 1.0 + i % 6), program, tally));
  }
  EXPECT_GT(tally.feasible, 5000);
  EXPECT_GT(tally.infeasible, 5000);
}

TEST(LinearProgram, ForgetsTheOthersWhereTheHardOnesContradictEachOther) {
  const std::vector<HalfPlane> half_planes = {
      {{1.0, 0.0}, 0.5}, {{-1.0, 0.0}, 0.1}, {{0.0, 1.0}, 0.9}};
  const VelocityChoice choice = LinearProgram().solve(half_planes, {0.0, 0.0}, 1.0, 2);
  EXPECT_DOUBLE_EQ(choice.violation_mps, 0.3);
  EXPECT_NEAR(choice.velocity_mps.x(), 0.2, 1e-12);
  EXPECT_LT(choice.velocity_mps.y(), 0.9);
}

TEST(LinearProgram, SolvesArbitraryHalfPlanes) {
  core::RandomStream random(2, "arbitrary");
  LinearProgram program;
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    ASSERT_NO_FATAL_FAILURE(check(arbitraryProblem(random), program, tally));
  }
  EXPECT_GT(tally.feasible, 5000);
  EXPECT_GT(tally.infeasible, 5000);
}

TEST(LinearProgram, OrderOfHalfPlanesChangesNothing) {
  core::RandomStream random(3, "order");
  LinearProgram program;
  for (int i = 0; i < 10000; ++i) {
    Problem problem = crowdProblem(random, 1.0 + i % 6);
    const auto solve = [&] {
      return program.solve(problem.half_planes, problem.preferred_mps, problem.max_speed_mps);
    };
    const VelocityChoice before = solve();
    random.shuffle(problem.half_planes);
    const VelocityChoice after = solve();
    EXPECT_NEAR((before.velocity_mps - after.velocity_mps).norm(), 0.0, 1e-6) << "problem " << i;
    EXPECT_NEAR(before.violation_mps, after.violation_mps, 1e-9) << "problem " << i;
  }
}

TEST(LinearProgram, WithoutHalfPlanesOnlySpeedLimits) {
  LinearProgram program;
  EXPECT_EQ(program.solve({}, {0.3, 0.4}, 1.0).velocity_mps, Vector2d(0.3, 0.4));
  EXPECT_EQ(program.solve({}, {0.0, 4.0}, 1.0).velocity_mps, Vector2d(0.0, 1.0));
}

TEST(LinearProgram, RepeatedAndOppositeHalfPlanesThatTouchAreKept) {
  const std::vector<HalfPlane> half_planes = {
      {{1.0, 0.0}, 0.5}, {{1.0, 0.0}, 0.5}, {{-1.0, 0.0}, -0.5}, {{-1.0, 0.0}, -0.5}};
  const VelocityChoice choice = LinearProgram().solve(half_planes, {-1.0, 0.25}, 1.0);
  EXPECT_EQ(choice.violation_mps, 0.0);
  EXPECT_EQ(choice.velocity_mps, Vector2d(0.5, 0.25));
}

TEST(LinearProgram, BetweenOppositeHalfPlanesTheSlowestOfEqualsIsTaken) {
  const std::vector<HalfPlane> half_planes = {{{1.0, 0.0}, 0.5}, {{-1.0, 0.0}, 0.5}};
  const VelocityChoice choice = LinearProgram().solve(half_planes, {0.0, 1.0}, 1.0);
  EXPECT_DOUBLE_EQ(choice.violation_mps, 0.5);
  EXPECT_EQ(choice.velocity_mps, Vector2d(0.0, 0.0));
}

TEST(LinearProgram, WithoutSpeedStandsStill) {
  const std::vector<HalfPlane> half_planes = {{{1.0, 0.0}, 0.5}};
  const VelocityChoice choice = LinearProgram().solve(half_planes, {1.0, 0.0}, 0.0);
  EXPECT_EQ(choice.velocity_mps, Vector2d(0.0, 0.0));
  EXPECT_DOUBLE_EQ(choice.violation_mps, 0.5);
}

}  // namespace
}  // namespace roundabout::planner
