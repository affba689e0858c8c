#include "planner/planner_node.h"

#include <array>

#include <spdlog/spdlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::planner {

namespace {

using Seconds = std::chrono::duration<double>;

constexpr std::array<const char*, 9> kModeNames{"waiting", "on floor", "taking off",
                                                "flying",  "at goal",  "holding",
                                                "landing", "landed",   "killed"};

roundabout_msgs::planner_status_t toMessage(const Status& status, const PlannerCore& core,
                                            double compute_time_s) {
  roundabout_msgs::planner_status_t message;
  message.utime = status.utime;
  message.action_probabilities.assign(status.decision.action_probabilities.begin(),
                                      status.decision.action_probabilities.end());
  message.num_actions = static_cast<std::int32_t>(message.action_probabilities.size());
  message.vehicle = core.vehicle().name;
  message.policy = core.policyName();
  message.mode = static_cast<std::int8_t>(status.mode);
  message.reason = status.reason;
  message.order_utime = core.obeyedOrder();
  message.goal_id = status.goal ? status.goal->goal_id : 0;
  message.goal_phase = status.goal ? static_cast<std::int8_t>(status.goal->phase) : std::int8_t{-1};
  message.distance_to_goal = status.distance_to_goal_m;
  message.chosen_action = status.decision.action;
  message.speed = status.decision.speed_mps;
  message.heading_change = status.decision.heading_change_rad;
  message.value = status.decision.value;
  message.neighbours_used = status.decision.neighbours_used;
  message.closest_separation = status.closest_separation_m;
  message.shield_interventions = 0;
  message.rejected_messages = status.rejected_messages;
  message.rejected_measurements = status.rejected_measurements;
  message.missed_ticks = status.missed_ticks;
  message.compute_time = compute_time_s;
  message.state_age = status.state_age_s;
  return message;
}

}  // namespace

bool watchesWallClock(const config::Experiment& experiment) {
  const bool lockstep = experiment.source == "sim" && experiment.sim.pacing == "lockstep";
  return experiment.planner.watch_wall_clock && !lockstep;
}

PlannerNode::PlannerNode(const config::Experiment& experiment, const std::string& vehicle,
                         std::unique_ptr<Policy> policy, bus::Bus& bus)
    : core_(experiment, vehicle, std::move(policy)),
      settings_(experiment.planner),
      safety_(experiment.safety),
      live_(watchesWallClock(experiment)),
      bus_(bus) {
  subscribe();
}

void PlannerNode::subscribe() {
  const auto on_error = [this](const bus::DecodeError& error) {
    reject(error.channel, error.reason);
  };
  bus::subscribe<roundabout_msgs::vehicle_states_t>(
      bus_, bus::kStatesChannel,
      [this](const roundabout_msgs::vehicle_states_t& message) { onStates(message); }, on_error);
  bus::subscribe<roundabout_msgs::goal_t>(
      bus_, bus::goalChannel(core_.vehicle().name),
      [this](const roundabout_msgs::goal_t& message) {
        core::Goal goal;
        if (const char* reason = bus::fromMessage(message, goal)) {
          reject("GOAL", reason);
        } else {
          core_.onGoal(goal);
        }
      },
      on_error);
  bus::subscribe<roundabout_msgs::safety_order_t>(
      bus_, bus::kSafetyOrderChannel,
      [this](const roundabout_msgs::safety_order_t& message) {
        core::SafetyOrder order;
        if (const char* reason = bus::fromMessage(message, order)) {
          reject(bus::kSafetyOrderChannel, reason);
        } else {
          core_.onOrder(order);
        }
      },
      on_error);
}

void PlannerNode::reject(std::string_view channel, const char* reason) {
  core_.onRejected();
  // One line for the first: a broken sender sends hundreds a second, and the status carries the
  // count.
  if (!rejection_logged_) {
    spdlog::warn("a message on {} was rejected: {}; further ones are only counted", channel,
                 reason);
    rejection_logged_ = true;
  }
}

void PlannerNode::onStates(const roundabout_msgs::vehicle_states_t& message) {
  const auto begin = std::chrono::steady_clock::now();
  if (bus::fromMessage(message, frame_) > 0) {
    reject(bus::kStatesChannel, "a vehicle's state is not finite or its orientation not unit");
  }
  const core::Utime before = core_.lastFrame();
  const auto tick = core_.onFrame(frame_);
  if (core_.lastFrame() > before) {
    last_frame_ = begin;
    landing_announced_ = false;
  }
  if (tick) {
    publish(*tick, Seconds(std::chrono::steady_clock::now() - begin).count());
  }
}

void PlannerNode::onWallClock(WallTime now) {
  const Seconds since_sent = now - last_sent_;
  const bool due = since_sent.count() >= 1.0 / settings_.rate_hz;
  if (!core_.started()) {
    if (due) {
      publishStatus(core_.waitingStatus(), 0.0);
      last_sent_ = now;
    }
    return;
  }
  const double silence_s = Seconds(now - last_frame_).count();
  if (!live_ || silence_s < safety_.states_hold_s) {
    return;
  }
  // At once when a limit is passed, then at the planning rate.
  const bool just_silent = Seconds(last_sent_ - last_frame_).count() < safety_.states_hold_s;
  const bool just_landing = silence_s >= safety_.states_land_s && !landing_announced_;
  if (due || just_silent || just_landing) {
    landing_announced_ = silence_s >= safety_.states_land_s;
    publish(core_.onSilence(silence_s), 0.0);
    last_sent_ = now;
  }
}

void PlannerNode::publish(const PlannerCore::Tick& tick, double compute_time_s) {
  // The status goes first: who has the command (a simulator in lockstep) may be sure that the
  // status is out too.
  publishStatus(tick.status, compute_time_s);
  bus::publish(bus_, bus::commandChannel(core_.vehicle().name), bus::toMessage(tick.command));
}

void PlannerNode::publishStatus(const Status& status, double compute_time_s) {
  logModeChange(status);
  bus::publish(bus_, bus::plannerStatusChannel(core_.vehicle().name),
               toMessage(status, core_, compute_time_s));
}

void PlannerNode::logModeChange(const Status& status) {
  if (status.mode == logged_mode_ && status.reason == logged_reason_) {
    return;
  }
  const auto level = status.mode == Mode::kHolding || status.mode == Mode::kKilled
                         ? spdlog::level::warn
                         : spdlog::level::info;
  spdlog::log(level, "{}{}{}", kModeNames[static_cast<std::size_t>(status.mode)],
              status.reason.empty() ? "" : ": ", status.reason);
  logged_mode_ = status.mode;
  logged_reason_ = status.reason;
}

}  // namespace roundabout::planner
