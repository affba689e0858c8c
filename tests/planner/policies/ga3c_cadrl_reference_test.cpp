// Against the published networks: their outputs (reference/ga3c_cadrl/golden) and flights of the
// published environment with one of them (reference/trajectories).

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/core/angles.h"
#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/policy_tools/import_checkpoint.h"
#include "tests/planner/policies/recorded_flights.h"
#include "tests/support/reference.h"

namespace roundabout::planner {
namespace {

class PublishedNetwork : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(test::referenceFolder() / "ga3c_cadrl")) {
      GTEST_SKIP() << "no published networks in " << test::referenceFolder();
    }
  }

  static std::shared_ptr<const Ga3cCadrlWeights> load(const std::string& folder,
                                                      const std::string& name) {
    const std::string prefix = test::referenceFolder() / "ga3c_cadrl/checkpoints" / folder / name;
    return toGa3cCadrlWeights(importCheckpoint(prefix), prefix);
  }

  static void expectGolden(const std::string& folder, const std::string& name) {
    Ga3cCadrlNetwork network(load(folder, name));
    std::ifstream lines(test::referenceFolder() / "ga3c_cadrl/golden" / (folder + ".jsonl"));
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
      const auto golden = nlohmann::json::parse(line);
      Observation observation;
      golden.at("ego").get_to(observation.ego);
      golden.at("others").get_to(observation.others);
      const Ga3cCadrlNetwork::Output output = network.evaluate(observation);
      const auto expected = golden.at("probs").get<std::vector<float>>();
      ASSERT_EQ(output.probabilities.size(), expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(output.probabilities[i], expected[i], 1e-5) << "line " << count + 1;
      }
      EXPECT_NEAR(output.value, golden.at("value").get<double>(), 1e-4) << "line " << count + 1;
      EXPECT_EQ(output.best_action,
                std::max_element(expected.begin(), expected.end()) - expected.begin())
          << "line " << count + 1;
    }
    EXPECT_EQ(count, 200);
  }
};

TEST_F(PublishedNetwork, GivesTheGoldenOutputsOfThePaper) {
  expectGolden("gym_IROS18_01900000", "network_01900000");
}

TEST_F(PublishedNetwork, GivesTheGoldenOutputsOfItsFirstPhase) {
  expectGolden("gym_jzuhlntn_01490000", "network_01490000");
}

// The published environment flew what the policy decides here, whenever the agent still flew.
void expectPublishedFlights(Policy& policy, int num_agents) {
  int compared = 0;
  for (const auto& [number, flight] :
       readFlights(test::referenceFolder(), "GA3C-CADRL-10", num_agents)) {
    for (std::size_t step = 0; step + 1 < flight.size(); ++step) {
      for (std::size_t self = 0; self < flight[step].size(); ++self) {
        if (flight[step][self].done) {
          continue;
        }
        const core::EgoAgent& now = flight[step][self].agent;
        const core::EgoAgent& next = flight[step + 1][self].agent;
        const Decision decision = policy.decide(now, othersOf(flight[step], self));
        const double turned_rad = core::wrapToPi(next.heading_world_rad - now.heading_world_rad);
        const double speed_mps = (next.position_world_m - now.position_world_m).norm() / 0.1;
        EXPECT_NEAR(turned_rad, decision.heading_change_rad, 1e-5)
            << "case " << number << ", step " << step << ", agent " << self;
        EXPECT_NEAR(speed_mps, decision.speed_mps, 1e-5)
            << "case " << number << ", step " << step << ", agent " << self;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 300);
}

TEST_F(PublishedNetwork, DecidesAsInThePublishedFlightsOfTwo) {
  Ga3cCadrl policy(load("gym_IROS18_01900000", "network_01900000"));
  expectPublishedFlights(policy, 2);
}

TEST_F(PublishedNetwork, DecidesAsInThePublishedFlightsOfFour) {
  Ga3cCadrl policy(load("gym_IROS18_01900000", "network_01900000"));
  expectPublishedFlights(policy, 4);
}

}  // namespace
}  // namespace roundabout::planner
