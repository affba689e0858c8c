#pragma once

namespace roundabout::learning {

/// The step in which the paper's rewards and discount are given. s
inline constexpr double kRewardStep_s = 0.2;
/// For kRewardStep_s.
inline constexpr double kDiscount = 0.97;

/// What came of a planning step for an agent.
struct StepOutcome {
  bool at_goal = false;
  bool collided = false;
  double gap_m = 0.0;  ///< between edges, to the closest other agent
};

/// The paper's reward (section "Learning the Policy", equation of R_col, with +1 at the goal). Two
/// things are ours: collision_reward may differ from -0.25, and whoever overlaps somebody when it
/// arrives has collided, since rules that let it off teach agents to dive into their neighbours.
double rewardOf(const StepOutcome& outcome, double planning_step_s, double collision_reward);

}  // namespace roundabout::learning
