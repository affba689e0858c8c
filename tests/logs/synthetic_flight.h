#pragma once

// A flight made up on paper: every vehicle where a function says, every message of a flight
// published at its rate. Tests change one thing and look at what the metrics say about it.

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "logs/flight.h"

namespace roundabout::logs {

struct SyntheticVehicle {
  std::string name;
  /// m, world, at s of data time since the first frame.
  std::function<Eigen::Vector3d(double)> position_world_m;
  double planner_dies_at_s = 1e9;
  double untracked_from_s = 1e9;
  double untracked_to_s = 1e9;
};

/// The fleet goes for the formation, holds it, then the next begins.
struct SyntheticFormation {
  std::string name;
  double begin_at_s = 0.0;
  double formed_at_s = 1e9;  ///< never: 1e9
  double end_at_s = 0.0;
  std::vector<Eigen::Vector3d> goals_world_m;  ///< for the first vehicles
  bool restarted = false;  ///< the step before again, by a fleet process that was restarted
};

struct SyntheticFlight {
  std::vector<SyntheticVehicle> vehicles;
  std::vector<SyntheticFormation> formations;
  double duration_s = 10.0;
  bool by_messages = false;  ///< the fleet is told letter by letter: its step never changes
  int steps_left_out = 0;    ///< of the mission, after the formations
  FleetPhase last_phase = FleetPhase::kDone;  ///< of the statuses after the formations
  double wall_clock_per_data = 0.1;           ///< 1: real time
  core::Utime command_delay_us = 2000;        ///< log time, state to command
  std::set<int> lost_frames;
  /// Added to a frame's log time, us.
  std::function<core::Utime(int)> frame_jitter_us;

  /// Writes the log; 200 Hz states, 10 Hz planners, 5 Hz fleet.
  void write(const std::string& log_file) const;

  /// Matching vehicles, with the defaults' radii and this preferred speed.
  config::Experiment experiment(double preferred_speed_mps = 1.0) const;
};

/// Straight from one point to another at a speed, from a time on; stands before and after.
std::function<Eigen::Vector3d(double)> straight(const Eigen::Vector3d& from,
                                                const Eigen::Vector3d& to, double speed_mps,
                                                double begin_at_s = 0.0);

std::function<Eigen::Vector3d(double)> standing(const Eigen::Vector3d& at);

/// Six vehicles that fly curved ways to C and L, as `fly` would have logged it: for looking at.
SyntheticFlight showcase();

}  // namespace roundabout::logs
