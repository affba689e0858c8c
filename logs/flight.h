#pragma once

// A flight as its log tells it, decoded. Times are data time (utime) unless they say log.

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "common/core/fleet_phase.h"
#include "common/core/planner_mode.h"
#include "common/core/shield_layer.h"
#include "common/core/time.h"
#include "logs/reading/event_scan.h"

namespace roundabout::logs {

using core::FleetPhase;
using core::PlannerMode;

/// A message with the wall-clock time at which the logger received it.
template <class Value>
struct Logged {
  core::Utime log_utime = 0;
  Value value;
};

/// One VEHICLE_STATES message. Its vehicles are in FlightVehicle::samples, at the same index.
struct Frame {
  core::Utime utime = 0;
  core::Utime log_utime = 0;
  std::int64_t number = 0;
};

/// One vehicle in one frame.
struct Sample {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  bool tracked = false;  ///< false: the rest must not be used
};

struct PlannerStatus {
  core::Utime utime = 0;  ///< 0: before the first state
  PlannerMode mode = PlannerMode::kWaiting;
  std::string policy;
  std::string reason;
  double compute_time_s = 0.0;
  core::ShieldLayer shield_layer = core::ShieldLayer::kNotAsked;
  double predicted_gap_m = std::numeric_limits<double>::infinity();
  int shield_interventions = 0;
  int rejected_messages = 0;
  int rejected_measurements = 0;
  int missed_ticks = 0;
};

struct FleetStatus {
  core::Utime utime = 0;  ///< 0: before the first state
  FleetPhase phase = FleetPhase::kWaiting;
  std::string formation;
  int step = -1;
  int num_steps = 0;
  std::string reason;
  std::vector<std::string> refusals;
};

/// A person of the simulator.
struct SeenPerson {
  std::int32_t id = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< world
  double radius_m = 0.0;
};

/// One PEDESTRIAN_TRUTH message: where people and vehicles really were.
struct PeopleFrame {
  core::Utime utime = 0;
  std::vector<SeenPerson> people;
  std::vector<Eigen::Vector2d> vehicles_m;  ///< in the order of the experiment
};

/// Everything logged about one vehicle.
struct FlightVehicle {
  std::string name;
  double assumed_radius_m = 0.0;
  double body_radius_m = 0.0;
  double preferred_speed_mps = 0.0;
  double top_speed_mps = 0.0;
  bool flies = true;                      ///< false: a robot on the floor
  std::vector<Sample> samples;            ///< one a frame
  std::vector<Logged<core::Goal>> goals;  ///< repetitions left out
  std::vector<Logged<core::Command>> commands;
  std::vector<Logged<PlannerStatus>> statuses;
};

/// Messages of one channel that could not be used.
struct Rejected {
  std::string channel;
  std::string reason;  ///< of the first one
  int count = 0;
};

struct Flight {
  std::string log_file;
  std::optional<config::Experiment> experiment;
  std::string experiment_note;     ///< where radii and speeds come from, for people
  double airborne_height_m = 0.0;  ///< below it a vehicle stands or lands
  double other_track_lost_s = 0.0;

  std::vector<Frame> frames;            ///< utime strictly growing
  int frames_out_of_order = 0;          ///< left out of frames: old, corrupt, of another flight
  std::vector<FlightVehicle> vehicles;  ///< in the order of the experiment file
  std::vector<Logged<FleetStatus>> fleet;
  std::vector<Logged<core::SafetyOrder>> safety_orders;  ///< repetitions left out

  std::vector<PeopleFrame> people;  ///< utime strictly growing; empty outside of the simulator

  std::vector<Rejected> rejected;  ///< by channel
  DamageReport damage;
  core::Utime log_begin_utime = 0;  ///< of the first and last event
  core::Utime log_end_utime = 0;

  /// s of data time since the first frame; 0 for a flight without frames.
  double secondsAt(core::Utime utime) const;
  core::Utime utimeAt(double seconds) const;
  /// Index of the first frame at or after the utime; frames.size() if there is none.
  std::size_t frameAt(core::Utime utime) const;
  /// Data time of the latest frame that was logged by then; that of the first frame before it.
  core::Utime dataTimeOf(core::Utime log_utime) const;
  /// Flown at the pace of the wall clock: what the experiment says, else what log times show.
  bool realTime() const;
  /// Tracked and, if it flies, higher than airborne_height_m.
  bool underWay(const FlightVehicle& vehicle, const Sample& sample) const;
};

/// Reads a log. Radii, names and speeds come from the experiment file: the given one, else
/// experiment.yaml beside the log, else the defaults of config::Vehicle. Damage and messages that
/// are no use are counted, never fatal. Throws core::StartupError if the log or the given
/// experiment file cannot be read.
///
/// Frames are judged by core::FrameGate. Where their time goes back for good, somebody began
/// another flight: only the one with most frames is read.
Flight readFlight(const std::string& log_file, const std::string& experiment_file = "");

}  // namespace roundabout::logs
