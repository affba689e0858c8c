#pragma once

#include <limits>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "common/core/command.h"
#include "common/core/planner_mode.h"
#include "common/core/shield_layer.h"
#include "planner/policy.h"

namespace roundabout::planner {

using Mode = core::PlannerMode;

/// A mode and why; the reason is empty while all is well.
struct Verdict {
  Mode mode = Mode::kWaiting;
  std::string reason;
};

/// What the shield made of a command. Velocities in m/s, world.
struct ShieldStatus {
  core::ShieldLayer layer = core::ShieldLayer::kNotAsked;
  Eigen::Vector2d wanted_world_mps = Eigen::Vector2d::Zero();
  Eigen::Vector2d flown_world_mps = Eigen::Vector2d::Zero();
  double predicted_gap_m = std::numeric_limits<double>::infinity();
  int interventions = 0;  ///< since start
};

/// What goes into planner_status_t, except what only the node knows (compute time).
struct Status {
  core::Utime utime = 0;
  Mode mode = Mode::kWaiting;
  std::string reason;
  std::optional<core::Goal> goal;
  double distance_to_goal_m = std::numeric_limits<double>::quiet_NaN();
  Decision decision;  ///< its probabilities are valid until the next tick
  double closest_separation_m = std::numeric_limits<double>::infinity();
  ShieldStatus shield;
  int rejected_messages = 0;
  int rejected_measurements = 0;
  int missed_ticks = 0;
  int tracks_used = 0;
  double tracks_age_s = std::numeric_limits<double>::quiet_NaN();
  int ticks_without_tracks = 0;  ///< since start
  double state_age_s = 0.0;
};

}  // namespace roundabout::planner
