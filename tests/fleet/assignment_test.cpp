#include "fleet/assignment.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "common/core/random.h"

namespace roundabout::fleet {
namespace {

std::vector<Eigen::Vector3d> randomPlaces(core::RandomStream& random, std::size_t count) {
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < count; ++i) {
    places.emplace_back(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(0, 2));
  }
  return places;
}

double cost(const std::vector<Eigen::Vector3d>& vehicles,
            const std::vector<Eigen::Vector3d>& points, const Assignment& assignment) {
  double total = 0.0;
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    if (assignment[i] != kUnassigned) {
      total += (vehicles[i] - points[assignment[i]]).squaredNorm();
    }
  }
  return total;
}

void expectEveryPointOnce(const Assignment& assignment, std::size_t points) {
  std::set<std::size_t> used;
  std::size_t unassigned = 0;
  for (const std::size_t point : assignment) {
    if (point == kUnassigned) {
      ++unassigned;
    } else {
      EXPECT_LT(point, points);
      EXPECT_TRUE(used.insert(point).second) << "point " << point << " twice";
    }
  }
  EXPECT_EQ(used.size(), points);
  EXPECT_EQ(unassigned, assignment.size() - points);
}

// Every way to give the points to the vehicles.
double cheapestByTrying(const std::vector<Eigen::Vector3d>& vehicles,
                        const std::vector<Eigen::Vector3d>& points) {
  std::vector<std::size_t> order(vehicles.size());
  std::iota(order.begin(), order.end(), 0u);
  double best = std::numeric_limits<double>::infinity();
  do {
    Assignment assignment(order);
    for (std::size_t& point : assignment) {
      point = point < points.size() ? point : kUnassigned;
    }
    best = std::min(best, cost(vehicles, points, assignment));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(OptimalAssignment, IsAsGoodAsTryingAllOfThem) {
  core::RandomStream random(1, "assignment test");
  for (int round = 0; round < 300; ++round) {
    const std::size_t vehicles_count = 1 + random.index(6);
    const std::size_t points_count = random.index(vehicles_count + 1);
    const auto vehicles = randomPlaces(random, vehicles_count);
    const auto points = randomPlaces(random, points_count);
    const Assignment assignment = assignOptimally(vehicles, points);
    expectEveryPointOnce(assignment, points_count);
    EXPECT_NEAR(cost(vehicles, points, assignment), cheapestByTrying(vehicles, points), 1e-9);
  }
}

TEST(OptimalAssignment, NoExchangeOfTwoMakesALargeOneCheaper) {
  core::RandomStream random(2, "assignment test");
  const auto vehicles = randomPlaces(random, 60);
  const auto points = randomPlaces(random, 60);
  Assignment assignment = assignOptimally(vehicles, points);
  expectEveryPointOnce(assignment, 60);
  const double best = cost(vehicles, points, assignment);
  for (std::size_t i = 0; i < 60; ++i) {
    for (std::size_t j = i + 1; j < 60; ++j) {
      std::swap(assignment[i], assignment[j]);
      EXPECT_GE(cost(vehicles, points, assignment), best - 1e-9);
      std::swap(assignment[i], assignment[j]);
    }
  }
}

TEST(OptimalAssignment, HandlesVehiclesInOnePlace) {
  const std::vector<Eigen::Vector3d> together(4, Eigen::Vector3d::Zero());
  expectEveryPointOnce(assignOptimally(together, together), 4);
}

TEST(RandomAssignment, DependsOnSeedAndStepOnly) {
  const Assignment first = assignAtRandom(10, 10, 7, "assignment/1");
  EXPECT_EQ(first, assignAtRandom(10, 10, 7, "assignment/1"));
  EXPECT_NE(first, assignAtRandom(10, 10, 8, "assignment/1"));
  EXPECT_NE(first, assignAtRandom(10, 10, 7, "assignment/2"));
}

TEST(RandomAssignment, GivesEveryPointToSomebody) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    expectEveryPointOnce(assignAtRandom(8, 5, seed, "a"), 5);
  }
}

TEST(RandomAssignment, IsUniform) {
  std::vector<int> first_vehicle(4, 0);
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    ++first_vehicle[assignAtRandom(4, 4, seed, "a")[0]];
  }
  for (const int count : first_vehicle) {
    EXPECT_NEAR(count, 1000, 120);  // 4.4 standard deviations
  }
}

TEST(InOrderAssignment, GivesPointIToVehicleI) {
  EXPECT_EQ(assignInOrder(3, 2), (Assignment{0, 1, kUnassigned}));
}

}  // namespace
}  // namespace roundabout::fleet
