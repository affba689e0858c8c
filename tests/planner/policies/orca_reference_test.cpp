// Against flights of the published environment (reference/trajectories), in which ORCA came from
// the RVO2 library in single precision.

#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/angles.h"
#include "planner/policies/orca/orca.h"
#include "tests/support/reference.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

// Rows of numbers below a line of titles.
std::vector<std::vector<double>> readTable(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) {
      row.push_back(std::stod(cell));
    }
    rows.push_back(row);
  }
  return rows;
}

// One line of trajectories/*.csv.
struct Sample {
  core::EgoAgent agent;
  bool done;
};

using Flight = std::vector<std::vector<Sample>>;  // [step][agent]

// Goals, radii and speeds come from the cases, everything else from the trajectories.
std::map<int, Flight> readFlights(const std::filesystem::path& folder, int num_agents) {
  const std::string n = std::to_string(num_agents);
  const auto cases = readTable(folder / "test_cases" / (n + "_agents_500_cases.csv"));
  std::map<int, Flight> flights;
  for (const auto& row : readTable(folder / "trajectories" / ("RVO_n" + n + ".csv"))) {
    const int case_number = static_cast<int>(row[0]);
    const std::size_t step = static_cast<std::size_t>(row[1]);
    const auto& constants = cases[static_cast<std::size_t>(case_number * num_agents + row[2])];
    Sample sample;
    sample.agent.position_world_m = {row[3], row[4]};
    sample.agent.velocity_world_mps = {row[5], row[6]};
    sample.agent.heading_world_rad = row[7];
    sample.agent.goal_world_m = {constants[4], constants[5]};
    sample.agent.radius_m = constants[6];
    sample.agent.preferred_speed_mps = constants[7];
    sample.done = row[8] + row[9] + row[10] > 0.0;
    Flight& flight = flights[case_number];
    flight.resize(std::max(flight.size(), step + 1));
    flight[step].push_back(sample);
  }
  return flights;
}

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
  for (const auto& [case_number, flight] : readFlights(folder, GetParam())) {
    for (std::size_t step = 0; step + 1 < flight.size(); ++step) {
      for (std::size_t self = 0; self < flight[step].size(); ++self) {
        if (flight[step][self].done) {
          continue;
        }
        std::vector<core::OtherAgent> others;
        for (std::size_t i = 0; i < flight[step].size(); ++i) {
          const core::EgoAgent& other = flight[step][i].agent;
          if (i != self) {
            others.push_back({other.position_world_m, other.velocity_world_mps, other.radius_m});
          }
        }
        const core::EgoAgent& now = flight[step][self].agent;
        const core::EgoAgent& next = flight[step + 1][self].agent;
        const Decision decision = policy->decide(now, others);
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
