#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/core/agent.h"

// Flights and cases of the published environment (reference/trajectories, reference/test_cases).

namespace roundabout::planner {

/// Rows of numbers below a line of titles.
inline std::vector<std::vector<double>> readTable(const std::filesystem::path& path) {
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

/// Per case the agents at its start: standing, heading to their goals.
inline std::vector<std::vector<core::EgoAgent>> readCases(const std::filesystem::path& reference,
                                                          int num_agents) {
  const std::string file = std::to_string(num_agents) + "_agents_500_cases.csv";
  std::vector<std::vector<core::EgoAgent>> cases;
  for (const auto& row : readTable(reference / "test_cases" / file)) {
    core::EgoAgent agent;
    agent.position_world_m = {row[2], row[3]};
    agent.goal_world_m = {row[4], row[5]};
    agent.radius_m = row[6];
    agent.preferred_speed_mps = row[7];
    const Eigen::Vector2d to_goal = agent.goal_world_m - agent.position_world_m;
    agent.heading_world_rad = std::atan2(to_goal.y(), to_goal.x());
    cases.resize(std::max(cases.size(), static_cast<std::size_t>(row[0]) + 1));
    cases.back().push_back(agent);
  }
  return cases;
}

/// One agent at one step. `done`: it moves no more.
struct Sample {
  core::EgoAgent agent;
  bool done;
};

using RecordedFlight = std::vector<std::vector<Sample>>;  // [step][agent]

/// By case number. Goals, radii and speeds come from the cases, the rest from POLICY_nN.csv.
inline std::map<int, RecordedFlight> readFlights(const std::filesystem::path& reference,
                                                 const std::string& policy, int num_agents) {
  const auto cases = readCases(reference, num_agents);
  std::map<int, RecordedFlight> flights;
  const std::string file = policy + "_n" + std::to_string(num_agents) + ".csv";
  for (const auto& row : readTable(reference / "trajectories" / file)) {
    const int case_number = static_cast<int>(row[0]);
    const std::size_t step = static_cast<std::size_t>(row[1]);
    Sample sample;
    sample.agent = cases[static_cast<std::size_t>(case_number)][static_cast<std::size_t>(row[2])];
    sample.agent.position_world_m = {row[3], row[4]};
    sample.agent.velocity_world_mps = {row[5], row[6]};
    sample.agent.heading_world_rad = row[7];
    sample.done = row[8] + row[9] + row[10] > 0.0;
    RecordedFlight& flight = flights[case_number];
    flight.resize(std::max(flight.size(), step + 1));
    flight[step].push_back(sample);
  }
  return flights;
}

/// What `self` is told of the others at one step. Their ids are their places in the flight.
inline std::vector<core::OtherAgent> othersOf(const std::vector<Sample>& agents, std::size_t self) {
  std::vector<core::OtherAgent> others;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    const core::EgoAgent& other = agents[i].agent;
    if (i != self) {
      others.push_back(
          {other.position_world_m, other.velocity_world_mps, other.radius_m, static_cast<int>(i)});
    }
  }
  return others;
}

}  // namespace roundabout::planner
