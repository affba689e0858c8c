// Against the published networks: their outputs (reference/ga3c_cadrl/golden) and flights of the
// published environment with one of them (reference/trajectories).

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/core/angles.h"
#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/policy_tools/import_checkpoint.h"
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

// Rows of a table of numbers, as column title to value.
std::vector<std::map<std::string, double>> readTable(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<std::string> titles;
  std::istringstream title_cells(line);
  for (std::string cell; std::getline(title_cells, cell, ',');) {
    titles.push_back(cell);
  }
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    auto& row = rows.emplace_back();
    for (const std::string& title : titles) {
      std::string cell;
      std::getline(cells, cell, ',');
      row[title] = std::stod(cell);
    }
  }
  return rows;
}

struct Sample {
  core::EgoAgent agent;
  bool done = false;
};

// [case][step][agent]
using Flights = std::map<int, std::map<int, std::map<int, Sample>>>;

// Goals, radii and speeds come from the cases, everything else from the trajectories.
Flights readFlights(int num_agents) {
  const std::string n = std::to_string(num_agents);
  const std::filesystem::path folder = test::referenceFolder();
  std::map<std::pair<int, int>, core::EgoAgent> agents;
  for (auto& row : readTable(folder / "test_cases" / (n + "_agents_500_cases.csv"))) {
    core::EgoAgent agent;
    agent.goal_world_m = {row["goal_x"], row["goal_y"]};
    agent.radius_m = row["radius"];
    agent.preferred_speed_mps = row["pref_speed"];
    agents[{static_cast<int>(row["case"]), static_cast<int>(row["agent"])}] = agent;
  }
  Flights flights;
  for (auto& row : readTable(folder / "trajectories" / ("GA3C-CADRL-10_n" + n + ".csv"))) {
    const int number = static_cast<int>(row["case"]);
    const int agent = static_cast<int>(row["agent"]);
    Sample sample;
    sample.agent = agents.at({number, agent});
    sample.agent.position_world_m = {row["x"], row["y"]};
    sample.agent.velocity_world_mps = {row["vx"], row["vy"]};
    sample.agent.heading_world_rad = row["heading"];
    sample.done = row["at_goal"] + row["in_collision"] + row["timed_out"] > 0.0;
    flights[number][static_cast<int>(row["step"])][agent] = sample;
  }
  return flights;
}

// The published environment flew what the policy decides here, whenever the agent still flew.
void expectPublishedFlights(Policy& policy, int num_agents) {
  int compared = 0;
  for (const auto& [number, flight] : readFlights(num_agents)) {
    for (const auto& [step, samples] : flight) {
      const auto next = flight.find(step + 1);
      if (next == flight.end()) {
        continue;
      }
      for (const auto& [index, sample] : samples) {
        if (sample.done) {
          continue;
        }
        std::vector<core::OtherAgent> others;
        for (const auto& [other_index, other] : samples) {
          if (other_index != index) {
            others.push_back({other.agent.position_world_m, other.agent.velocity_world_mps,
                              other.agent.radius_m});
          }
        }
        const Decision decision = policy.decide(sample.agent, others);
        const core::EgoAgent& flown = next->second.at(index).agent;
        const double turned_rad =
            core::wrapToPi(flown.heading_world_rad - sample.agent.heading_world_rad);
        const double speed_mps =
            (flown.position_world_m - sample.agent.position_world_m).norm() / 0.1;
        EXPECT_NEAR(turned_rad, decision.heading_change_rad, 1e-5)
            << "case " << number << ", step " << step << ", agent " << index;
        EXPECT_NEAR(speed_mps, decision.speed_mps, 1e-5)
            << "case " << number << ", step " << step << ", agent " << index;
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
