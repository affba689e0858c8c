#include "learning/evaluation/rules.h"

#include <array>
#include <numbers>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/config/words.h"
#include "common/core/error.h"

namespace roundabout::learning {

namespace {

constexpr std::array<std::string_view, 2> kNames{"published", "lab"};

}  // namespace

std::span<const std::string_view> rulesNames() { return kNames; }

Rules makeRules(const std::string& name) {
  Rules rules;
  rules.name = name;
  if (name == "published") {
    rules.orca.max_heading_change_rad = std::numbers::pi / 6.0;
    rules.orca.right_bias_rad = 0.0;
    return rules;
  }
  if (name == "lab") {
    constexpr double kDelay_s = 0.1;  // from the exposure of a frame to the effect of its command
    rules.lab = true;
    rules.body_share = 0.7;
    rules.loss = 0.05;
    rules.synchronised = false;
    rules.command_valid_s = 0.3;
    rules.sim.multirotor.command_delay_s = kDelay_s - rules.sim.mocap.latency_s;
    rules.shield.margin_m = 0.03;
    rules.shield.multirotor.delay_s = kDelay_s;
    rules.shield.multirotor.lag_s = 1.0 / rules.sim.multirotor.velocity_gain_per_s;
    rules.shield.multirotor.inner_lag_s = rules.sim.multirotor.attitude_time_constant_s;
    return rules;
  }
  throw core::StartupError("--rules", "name", fmt::format("one of {}", fmt::join(kNames, ", ")),
                           config::inQuotes(name));
}

void slowDown(Rules& rules, double factor) {
  config::MultirotorModel& model = rules.sim.multirotor;
  const double latency_s = rules.sim.mocap.latency_s;
  model.velocity_gain_per_s /= factor;
  model.attitude_time_constant_s *= factor;
  model.command_delay_s = factor * (model.command_delay_s + latency_s) - latency_s;
}

std::vector<std::string> Rules::sentences() const {
  std::vector<std::string> all;
  if (lab) {
    all = {fmt::format("Agents are multirotors (docs/multirotor.md) that have taken off; planners "
                       "act every {} s on motion capture at {} Hz with {} ms of latency and {} mm "
                       "of noise.",
                       planning_step_s, sim.mocap.rate_hz, 1e3 * sim.mocap.latency_s,
                       1e3 * sim.mocap.position_noise_m),
           fmt::format("A command takes effect {:.0f} ms after the exposure of the frame that it "
                       "answers and is valid for {} s; velocities follow with a lag of {:.3f} s. "
                       "The shield counts on {:.0f} ms and {:.3f} s, and keeps {} m.",
                       1e3 * (sim.multirotor.command_delay_s + sim.mocap.latency_s),
                       command_valid_s, 1.0 / sim.multirotor.velocity_gain_per_s,
                       1e3 * shield.multirotor.delay_s, shield.multirotor.lag_s, shield.margin_m),
           fmt::format("{}; {} % of all states and commands are lost on the way to each listener.",
                       synchronised ? "All planners act on the same frames"
                                    : "Planners are not synchronised",
                       100.0 * loss),
           "The planner's command law and safety table hold: speed and turn shrink within 2 m of "
           "the goal, position control takes over within 0.3 m."};
  } else {
    all = {fmt::format("Agents do at once what they decide: every {} s all decide on the same "
                       "state, turn, then move; there is no limit on the turn rate.",
                       planning_step_s),
           "At first all head for their goals, and their velocities are zero.",
           "Who has arrived, collided or got stuck stands still where it is and can be hit."};
  }
  all.push_back(fmt::format("Arrived: the centre within {} m of the goal.", goal_distance_m));
  all.push_back(
      body_share == 1.0
          ? std::string("Collision: centres no farther apart than the sum of the radii. Who has "
                        "arrived keeps that, and whoever hits it has collided.")
          : fmt::format("Collision: centres no farther apart than {} of the sum of the radii that "
                        "policies see, at any time since the take-off, arrived or not.",
                        body_share));
  all.push_back(fmt::format(
      "Obstacles, where there are some, stand: a collision is a centre no farther from one than {}"
      "the radius, and separations count them.",
      body_share == 1.0 ? "" : fmt::format("{} of ", body_share)));
  all.push_back(
      fmt::format("Straight-line time: (distance from start to goal - {} m) / preferred "
                  "speed. Stuck: not arrived after {} times that.",
                  goal_distance_m, time_ratio));
  all.push_back(
      "A case is a collision if any agent collided, else stuck if any got stuck, else a "
      "success.");
  all.push_back(
      "Extra time of a case: mean over its agents of the time until they were done "
      "minus the straight-line time.");
  all.push_back(fmt::format(
      "ORCA: time horizon {} s, radii times {}, turns in place beyond {:.3f} "
      "rad, leans {} rad to the right when it cannot go straight.",
      orca.time_horizon_s, orca.radius_factor, orca.max_heading_change_rad, orca.right_bias_rad));
  return all;
}

}  // namespace roundabout::learning
