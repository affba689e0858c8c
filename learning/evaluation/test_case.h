#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/core/agent.h"

namespace roundabout::learning {

/// One agent of a test case. World frame.
struct AgentSpec {
  Eigen::Vector2d start_m{0.0, 0.0};
  Eigen::Vector2d goal_m{0.0, 0.0};
  double radius_m = 0.5;
  double preferred_speed_mps = 1.0;
  /// At first; nothing: toward the goal. The lab's vehicles have no other.
  std::optional<double> heading_rad{};
};

/// Agents that all begin at rest.
struct TestCase {
  std::vector<AgentSpec> agents;
  /// Goals that are flown to afterwards, one after the other, in the order of the agents: places
  /// and headings are kept, speeds and clocks start anew.
  std::vector<std::vector<Eigen::Vector2d>> later_goals_m;
  std::vector<core::Polygon> obstacles{};
};

/// Cases that belong in one row of a table.
struct CaseGroup {
  std::string name;  ///< "4 agents"
  std::vector<TestCase> cases;
};

}  // namespace roundabout::learning
