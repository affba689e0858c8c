#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/experiment.h"

namespace roundabout::learning {

/// How test cases are run and judged. A plain description: whoever runs a case does what it says.
struct Rules {
  std::string name;
  double planning_step_s = 0.1;
  double goal_distance_m = 0.2;   ///< between centre and goal: arrived
  double time_ratio = 8.0;        ///< of the straight-line time: who needs longer is stuck
  double time_allowance_s = 0.0;  ///< this much is added to that
  double body_share = 1.0;        ///< of an agent's radius: what collides
  bool lab = false;   ///< multirotors, motion capture and planners instead of ideal agents
  config::Orca orca;  ///< ORCA's settings under these rules
  config::Sim sim;    ///< of the lab
  double loss = 0.0;  ///< of messages: states to a planner, commands to whoever should hear them
  bool synchronised = true;      ///< all planners of the lab act on the same frames
  double command_valid_s = 0.3;  ///< in the lab
  config::Shield shield;         ///< what the lab's shield assumes of vehicles

  /// One sentence each, for the report.
  std::vector<std::string> sentences() const;
};

/// Names of all rules.
std::span<const std::string_view> rulesNames();

/// "published": those of the published environment's FullTestSuite (gym-collision-avoidance).
/// "lab": what this project flies, with messages that get lost. Throws core::StartupError for an
/// unknown name.
Rules makeRules(const std::string& name);

/// Vehicles of the lab whose lag and delay are `factor` times what the shield assumes.
void slowDown(Rules& rules, double factor);

}  // namespace roundabout::learning
