#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "learning/evaluation/crossing/eyes.h"
#include "planner/policy.h"
#include "sim/pedestrians/encounters.h"
#include "sim/pedestrians/steering.h"

namespace roundabout::learning {

/// How one robot got through the people of an experiment.
struct CrossingResult {
  bool reached = false;  ///< by what it knows of its place, as the fleet judges a flight
  double off_goal_m = std::numeric_limits<double>::quiet_NaN();  ///< truly, at the end
  double time_s = 0.0;  ///< until reached, else until given up
  /// Beyond the straight way at preferred speed; NaN if it did not arrive.
  double extra_time_s = std::numeric_limits<double>::quiet_NaN();
  double closest_m = std::numeric_limits<double>::infinity();  ///< to a person's body
  int collisions_by_robot = 0;                    ///< it moved towards the person when they met
  int collisions_by_person = 0;                   ///< it stood or gave way, and was walked into
  std::optional<sim::Encounter> first_collision;  ///< with a person
  double first_collision_s = std::numeric_limits<double>::quiet_NaN();
  int collisions_with_things = 0;
  int ticks = 0;
  int ticks_blind = 0;     ///< it held because perception was silent or blind
  int ticks_shielded = 0;  ///< something else was driven than the policy wanted
};

/// Where everybody was at the planner's ticks.
struct CrossingTrace {
  struct Person {
    std::int32_t id;
    Eigen::Vector2d position_m;
  };
  struct Moment {
    double time_s;
    Eigen::Vector2d robot_m;
    double heading_rad;
    std::vector<Person> people;
  };
  std::vector<Moment> moments;
  std::vector<Eigen::Vector2d> collisions_m;  ///< where the robot was when it met a person
  Eigen::Vector2d goal_m = Eigen::Vector2d::Zero();
};

/// What is made anew for every run.
struct CrossingCast {
  std::function<std::unique_ptr<Eyes>(const config::Experiment&, const std::string&)> eyes;
  std::function<std::unique_ptr<planner::Policy>()> policy;
  sim::SteeringFactory steering;
};

/// Drives the experiment's first vehicle to the first point of its mission: the simulator's world
/// and sensors, the eyes and a planner's core on one clock, without wires. A scan and the tracks
/// that come of it take effect as in a flight in lockstep. Gives up after fleet.step_timeout_s.
/// Throws core::StartupError: no lidar, no point to drive to, as sim::World.
CrossingResult runCrossing(const config::Experiment& experiment, const CrossingCast& cast,
                           CrossingTrace* trace = nullptr);

/// Throws what runCrossing() would throw at its start.
void requireCrossing(const config::Experiment& experiment, const CrossingCast& cast);

/// Of many runs.
struct CrossingSummary {
  int runs = 0;
  int reached = 0;
  int runs_hit_by_robot = 0;
  int runs_hit_by_person = 0;
  int runs_hit_things = 0;
  double closest_m = std::numeric_limits<double>::infinity();
  double median_closest_m = std::numeric_limits<double>::quiet_NaN();
  double mean_extra_s = std::numeric_limits<double>::quiet_NaN();  ///< of those who arrived
  double p90_extra_s = std::numeric_limits<double>::quiet_NaN();
  double blind_share = 0.0;  ///< of ticks
  double shielded_share = 0.0;
};

CrossingSummary summarise(std::span<const CrossingResult> results);

}  // namespace roundabout::learning
