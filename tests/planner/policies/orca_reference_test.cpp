// Against flights of the published environment (reference/trajectories), in which ORCA came from
// the RVO2 library in single precision.

#include <cmath>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>

#include "common/core/angles.h"
#include "planner/policies/orca/orca.h"
#include "tests/planner/policies/recorded_flights.h"
#include "tests/support/reference.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

class OrcaReference : public ::testing::TestWithParam<int> {};

TEST_P(OrcaReference, EveryRecordedStepIsRepeated) {
  const std::filesystem::path folder = test::referenceFolder();
  if (!std::filesystem::exists(folder / "trajectories")) {
    GTEST_SKIP() << "no reference data in " << folder;
  }
  PolicyOptions published;
  published.orca.max_heading_change_rad = std::numbers::pi / 6.0;
  published.orca.right_bias_rad = 0.0;
  const auto policy = makeOrca(published);

  int steps = 0;
  for (const auto& [case_number, flight] : readFlights(folder, "RVO", GetParam())) {
    for (std::size_t step = 0; step + 1 < flight.size(); ++step) {
      for (std::size_t self = 0; self < flight[step].size(); ++self) {
        if (flight[step][self].done) {
          continue;
        }
        const core::EgoAgent& now = flight[step][self].agent;
        const core::EgoAgent& next = flight[step + 1][self].agent;
        const Decision decision = policy->decide(now, othersOf(flight[step], self));
        const double heading = now.heading_world_rad + decision.heading_change_rad;
        const Vector2d position =
            now.position_world_m +
            0.1 * decision.speed_mps * Vector2d(std::cos(heading), std::sin(heading));
        // Single precision of a position of up to 9 m; a slow step's direction is less certain.
        EXPECT_NEAR((position - next.position_world_m).norm(), 0.0, 1e-5)
            << "case " << case_number << " step " << step << " agent " << self;
        EXPECT_NEAR(core::wrapToPi(heading - next.heading_world_rad), 0.0, 1e-4)
            << "case " << case_number << " step " << step << " agent " << self;
        ++steps;
      }
    }
  }
  EXPECT_GT(steps, 400);
}

INSTANTIATE_TEST_SUITE_P(PublishedCases, OrcaReference, ::testing::Values(2, 4));

}  // namespace
}  // namespace roundabout::planner
