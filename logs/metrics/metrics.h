#pragma once

// What a flight amounts to. Every rule is stated in docs/logs.md; times "_at_s" are data time since
// the first frame. NaN: does not exist or cannot be known.

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "logs/flight.h"
#include "logs/metrics/statistics.h"

namespace roundabout::logs {

/// A gap is the horizontal distance of two centres minus two radii, unless both vehicles rest on
/// the floor: body radii for a gap between bodies, assumed radii for a gap between what policies
/// see.
struct ClosestGap {
  double gap_m = std::numeric_limits<double>::infinity();  ///< infinite: there is none
  double at_s = std::numeric_limits<double>::quiet_NaN();
  std::string vehicle_a;
  std::string vehicle_b;
};

/// A time during which a gap of two vehicles was below zero.
struct Encounter {
  std::string vehicle_a;
  std::string vehicle_b;
  double begin_at_s = 0.0;
  double end_at_s = 0.0;
  double time_below_s = 0.0;  ///< at most end - begin
  double closest_gap_m = 0.0;
};

/// A time in which the cameras did not see a vehicle for so long that it may have met others
/// or obstacles.
struct Unseen {
  std::string vehicle;
  double begin_at_s = 0.0;
  double end_at_s = 0.0;
  std::vector<std::string> near;  ///< what it could have reached
};

struct PairMetrics {
  ClosestGap body_gap;
  int touches = 0;
  int approaches = 0;
};

/// Both vehicles' safety over the flight.
struct SeparationMetrics {
  ClosestGap body_gap;
  ClosestGap assumed_gap;
  std::vector<PairMetrics> pairs;
  std::vector<Encounter> touches;     ///< bodies met: collisions
  std::vector<Encounter> approaches;  ///< closer than the assumed radii
  std::vector<Unseen> unseen;         ///< when nobody can tell whether bodies met
  double touching_time_s = 0.0;       ///< sum over touches
  double approaching_time_s = 0.0;    ///< sum over approaches
};

/// Bodies that do not rest and the experiment's obstacles; vehicle_b is the obstacle's name.
struct ObstacleMetrics {
  ClosestGap closest;
  std::vector<ClosestGap> touches;  ///< the deepest of each body with each obstacle
  std::vector<Unseen> unseen;       ///< when nobody can tell whether a body touched one
};

/// Vehicles that move and the people of the simulator; vehicle_b is "pedestrian <id>".
struct PeopleMetrics {
  int people = 0;  ///< that were there at some time
  ClosestGap closest;
  std::vector<ClosestGap> touches;  ///< when each began
};

/// One vehicle's way to its place in a formation.
struct LegMetrics {
  std::string vehicle;
  Eigen::Vector3d goal_world_m = Eigen::Vector3d::Zero();
  bool reached = false;    ///< came within kGoalDistanceM, horizontally
  double goal_at_s = 0.0;  ///< when the goal was given
  double time_to_goal_s = std::numeric_limits<double>::quiet_NaN();
  double straight_line_m = 0.0;  ///< horizontal, from where it was to the goal
  /// time_to_goal_s beyond (straight_line_m - kGoalDistanceM) / preferred speed, the least possible
  double extra_time_s = std::numeric_limits<double>::quiet_NaN();
  double path_length_m = 0.0;  ///< until reached, else until the formation ended
};

/// m. Within this a vehicle has arrived, as far as times are concerned.
inline constexpr double kGoalDistanceM = 0.3;

struct FormationMetrics {
  std::string name;
  int step = -1;
  bool formed = false;      ///< the fleet said so and everybody had reached its goal
  double begin_at_s = 0.0;  ///< goals given
  double end_at_s = 0.0;    ///< left again, or the log ended
  double time_to_form_s = std::numeric_limits<double>::quiet_NaN();
  std::vector<LegMetrics> legs;
  ClosestGap body_gap;  ///< from begin to end
  int touches = 0;      ///< encounters that began in between
  int approaches = 0;
};

/// What the shield made of a vehicle's commands.
struct ShieldMetrics {
  int steps = 0;          ///< planning ticks on which it was asked
  int interventions = 0;  ///< on which it had something else flown; its own count
  /// The same by layer, in their order, as far as statuses are in the log; layers that occurred.
  std::vector<std::pair<core::ShieldLayer, int>> by_layer;
  /// The smallest gap between the brake paths of this vehicle and any other; infinite: none.
  double smallest_predicted_gap_m = std::numeric_limits<double>::infinity();

  /// Of the steps; 0 if there were none.
  double changedShare() const;
};

struct VehicleMetrics {
  std::string name;
  std::string policy;
  double path_length_m = 0.0;
  double max_speed_mps = 0.0;
  double max_acceleration_mps2 = 0.0;
  double untracked_time_s = 0.0;
  std::vector<std::pair<PlannerMode, double>> time_in_mode_s;  ///< modes that occurred
  int commands = 0;
  double command_rate_hz = 0.0;  ///< in data time
  Spread command_latency_s;      ///< log times, state to the command that answers it
  Spread compute_time_s;
  ShieldMetrics shield;
  int rejected_messages = 0;
  int rejected_measurements = 0;
  int missed_ticks = 0;
};

/// Limits of a steady stream of frames: 200 +- 0.5 Hz, and 1 ms of the 5 ms between frames.
inline constexpr double kRateTolerance = 0.0025;
inline constexpr double kIntervalErrorTolerance = 0.2;

struct TimingMetrics {
  bool real_time = false;
  int frames = 0;
  std::int64_t missing_frames = 0;  ///< gaps in the frame number
  int frames_out_of_order = 0;
  double data_duration_s = 0.0;
  double log_duration_s = 0.0;      ///< wall clock, first to last frame
  double real_time_factor = 0.0;    ///< data time per wall clock
  double nominal_interval_s = 0.0;  ///< median of the frames' data intervals
  // From log times, so meaningful in real time only:
  double rate_hz = 0.0;
  Spread interval_error_s;  ///< |interval - nominal|
  double longest_interval_s = 0.0;
  bool steady = false;  ///< within the limits above (p99 of the error), no frame missing
};

struct PhaseMetrics {
  FleetPhase phase = FleetPhase::kWaiting;
  std::string formation;
  int step = -1;
  double begin_at_s = 0.0;
  double end_at_s = 0.0;
};

/// Somebody who stopped publishing for longer than kSilenceS of data time.
struct Silence {
  std::string who;  ///< "planner of hex1", "fleet", "vehicle states"
  double begin_at_s = 0.0;
  double end_at_s = 0.0;  ///< heard again, or the end of the flight
  bool returned = false;
};

/// s. Ten planning ticks without a word.
inline constexpr double kSilenceS = 1.0;

struct SafetyOrderSeen {
  double at_s = 0.0;
  std::string order;
  std::string vehicle;  ///< empty: all
};

struct FaultMetrics {
  std::vector<Silence> silences;
  std::vector<SafetyOrderSeen> safety_orders;
  std::vector<std::string> refusals;  ///< missions, each once
};

struct Metrics {
  bool success = false;
  std::vector<std::string> failures;  ///< why not, one line each; empty on success
  TimingMetrics timing;
  SeparationMetrics separation;
  ObstacleMetrics obstacles;
  PeopleMetrics people;
  std::vector<FormationMetrics> formations;
  std::vector<VehicleMetrics> vehicles;
  std::vector<PhaseMetrics> phases;
  FaultMetrics faults;

  int formationsFormed() const;
};

/// Pure: the same flight gives the same metrics, simulated or real.
Metrics computeMetrics(const Flight& flight);

}  // namespace roundabout::logs
