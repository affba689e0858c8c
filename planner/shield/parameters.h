#pragma once

#include <string_view>

namespace roundabout::planner::shield {

/// Everything the shield can be told. The bounds of vehicles are with the vehicles (MotionBounds).
struct ShieldParameters {
  double period_s = 0.1;  ///< between decisions
  double hold_s = 0.3;    ///< commands expire so long after they were issued: delay and two periods
  double margin_m = 0.03;  ///< between bodies: errors of measurement and of prediction
  /// A command is slowed down rather than turned. For ideal agents whose policies count on their
  /// headings.
  bool keeps_heading = false;
  double height_separation_m = 0.6;  ///< vehicles farther apart vertically pass each other

  // The whole gap, and more, for vehicles that are not shielded or not tracked.
  double unshielded_margin_m = 0.1;
  double unshielded_prediction_s = 0.45;
  double unshielded_horizon_s = 3.5;

  double look_ahead_s = 1.0;  ///< 0: none
  double look_ahead_gap_m = 0.05;

  bool breaker = true;
  /// Within this distance of the goal what a policy wants is slowed down linearly, and turns the
  /// less; 0: nowhere.
  double slow_down_distance_m = 0.0;
  double progress_time_constant_s = 2.0;  ///< 1 in the lab, and for policies without memory
  double stalled_share = 0.2;             ///< of the preferred speed; slower: stalled
  double breaker_horizon_s = 2.0;
  double block_horizon_s = 1.0;  ///< nearer in time than this, somebody blocks
  bool steps_aside = false;
  double step_aside_gain_per_s = 1.2;  ///< position error to velocity

  /// Agents that do at once what they decide, on true states, all at the same time: the published
  /// rules. A command is flown for one step.
  static ShieldParameters idealRules();
  /// For what a policy of the table is: those without a memory do not get on by waiting.
  void suit(std::string_view policy);
  /// Vehicles with lag and delay, noise and losses, unsynchronised.
  static ShieldParameters lab();
};

}  // namespace roundabout::planner::shield
