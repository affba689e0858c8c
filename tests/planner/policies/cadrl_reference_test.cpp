// Against flights of the published environment (reference/trajectories) with the published network.
// How its 500 cases end is compared in tests/learning/evaluation/published_outcomes_test.cpp.

#include <cmath>
#include <iostream>
#include <memory>

#include <gtest/gtest.h>

#include "common/core/angles.h"
#include "planner/policies/cadrl/cadrl.h"
#include "tests/planner/policies/recorded_flights.h"
#include "tests/support/reference.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

constexpr double kStepS = 0.1;

std::filesystem::path publishedNetwork() {
  return test::referenceFolder() / "cadrl" / "no_constr_none_4_agents_policy_iter_1000.safetensors";
}

std::unique_ptr<Policy> makePublished() {
  PolicyOptions options;
  options.weights = publishedNetwork();
  return makeCadrl(options);
}

class CadrlRecorded : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(publishedNetwork())) {
      GTEST_SKIP() << "no published network at " << publishedNetwork();
    }
  }
};

TEST_P(CadrlRecorded, EveryRecordedStepIsRepeated) {
  const auto policy = makePublished();
  int steps = 0;
  int repeated = 0;
  for (const auto& [case_number, flight] :
       readFlights(test::referenceFolder(), "CADRL", GetParam())) {
    for (std::size_t self = 0; self < flight[0].size(); ++self) {
      policy->reset();
      for (std::size_t step = 0; step + 1 < flight.size() && !flight[step][self].done; ++step) {
        const core::EgoAgent& now = flight[step][self].agent;
        const core::EgoAgent& next = flight[step + 1][self].agent;
        const Decision decision = policy->decide(now, othersOf(flight[step], self));
        const double heading = now.heading_world_rad + decision.heading_change_rad;
        const Vector2d position =
            now.position_world_m +
            kStepS * decision.speed_mps * Vector2d(std::cos(heading), std::sin(heading));
        // Actions were stored in single precision.
        const bool same = (position - next.position_world_m).norm() < 1e-6 &&
                          std::abs(core::wrapToPi(heading - next.heading_world_rad)) < 1e-6;
        EXPECT_TRUE(same) << "case " << case_number << " step " << step << " agent " << self;
        ++steps;
        repeated += same ? 1 : 0;
      }
    }
  }
  EXPECT_GT(steps, 350);
  std::cout << repeated << " of " << steps << " recorded decisions repeated\n";
}

INSTANTIATE_TEST_SUITE_P(PublishedCases, CadrlRecorded, ::testing::Values(2, 4));

}  // namespace
}  // namespace roundabout::planner
