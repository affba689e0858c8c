#include "planner/planner_node.h"

#include <spdlog/spdlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::planner {

namespace {

using Seconds = std::chrono::duration<double>;

// How often onWallClock() is called, at least.
constexpr Seconds kCallPeriod(0.01);
// In lockstep everybody may be slow; after this much silence there is nobody any more.
constexpr Seconds kNotice(1.0);

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
  message.shield_layer = static_cast<std::int8_t>(status.shield.layer);
  Eigen::Map<Eigen::Vector2d>(message.wanted_velocity) = status.shield.wanted_world_mps;
  Eigen::Map<Eigen::Vector2d>(message.flown_velocity) = status.shield.flown_world_mps;
  message.predicted_gap = status.shield.predicted_gap_m;
  message.shield_interventions = status.shield.interventions;
  message.rejected_messages = status.rejected_messages;
  message.rejected_measurements = status.rejected_measurements;
  message.missed_ticks = status.missed_ticks;
  message.tracks_used = status.tracks_used;
  message.tracks_age = status.tracks_age_s;
  message.ticks_without_tracks = status.ticks_without_tracks;
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
          reject(bus::goalChannel(core_.vehicle().name), reason);
        } else if (const char* refusal = core_.onGoal(goal)) {
          logRejection(bus::goalChannel(core_.vehicle().name), refusal);
        }
      },
      on_error);
  bus::subscribe<roundabout_msgs::safety_order_t>(
      bus_, bus::kSafetyOrderChannel,
      [this](const roundabout_msgs::safety_order_t& message) {
        core::SafetyOrder order;
        if (const char* reason = bus::fromMessage(message, order)) {
          reject(bus::kSafetyOrderChannel, reason);
        } else if (const char* refusal = core_.onOrder(order)) {
          logRejection(bus::kSafetyOrderChannel, refusal);
        } else if (core_.killed()) {
          publish(core_.killNow(), 0.0);
        }
      },
      on_error);
  subscribeOthersCommands();
  subscribeMap();
  if (core_.needsScans()) {
    subscribeScans();
  }
  if (core_.needsTracks()) {
    subscribeTracks();
  }
}

void PlannerNode::subscribeMap() {
  const std::string channel = bus::occupancyChannel(core_.vehicle().name);
  bus::subscribe<roundabout_msgs::occupancy_t>(
      bus_, channel,
      [this, channel,
       map = core::OccupancyMap()](const roundabout_msgs::occupancy_t& message) mutable {
        const char* const reason = message.vehicle == core_.vehicle().name
                                       ? bus::fromMessage(message, map)
                                       : "names another vehicle than its channel";
        if (reason != nullptr) {
          reject(channel, reason);
        } else if (const char* refusal = core_.onMap(map)) {
          logRejection(channel, refusal);
        }
      },
      [this](const bus::DecodeError& error) { reject(error.channel, error.reason); });
}

void PlannerNode::subscribeOthersCommands() {
  for (const config::Vehicle& other : core_.experiment().vehicles) {
    if (other.name == core_.vehicle().name) {
      continue;
    }
    const std::string channel = bus::commandChannel(other.name);
    bus::subscribe<roundabout_msgs::command_t>(
        bus_, channel,
        [this, channel, name = other.name](const roundabout_msgs::command_t& message) {
          core::Command command;
          const char* const reason = message.vehicle == name
                                         ? bus::fromMessage(message, command)
                                         : "names another vehicle than its channel";
          if (reason != nullptr) {
            reject(channel, reason);
          } else if (const char* refusal = core_.onOthersCommand(command)) {
            logRejection(channel, refusal);
          }
        },
        [this](const bus::DecodeError& error) { reject(error.channel, error.reason); });
  }
}

void PlannerNode::subscribeScans() {
  const std::string channel = bus::laserScanChannel(core_.vehicle().name);
  bus::subscribe<roundabout_msgs::planar_lidar_t>(
      bus_, channel,
      [this, channel,
       scan = core::LaserScan()](const roundabout_msgs::planar_lidar_t& message) mutable {
        if (const char* reason = bus::fromMessage(message, scan)) {
          reject(channel, reason);
        } else if (const char* refusal = core_.onScan(scan)) {
          logRejection(channel, refusal);
        }
      },
      [this](const bus::DecodeError& error) { reject(error.channel, error.reason); });
}

void PlannerNode::subscribeTracks() {
  const std::string channel = bus::agentTracksChannel(core_.vehicle().name);
  bus::subscribe<roundabout_msgs::agent_tracks_t>(
      bus_, channel,
      [this, channel,
       tracks = core::AgentTracks()](const roundabout_msgs::agent_tracks_t& message) mutable {
        int left_out = 0;
        const char* const reason = message.vehicle == core_.vehicle().name
                                       ? bus::fromMessage(message, tracks, left_out)
                                       : "names another vehicle than its channel";
        if (reason != nullptr) {
          reject(channel, reason);
          return;
        }
        if (left_out > 0) {
          // Somebody is there, and nobody can tell where.
          reject(channel, "a track is not finite, or has no size");
          tracks.health = core::PerceptionHealth::kBlind;
          tracks.reason = "a track is not finite, or has no size";
        }
        if (const char* refusal = core_.onTracks(tracks)) {
          logRejection(channel, refusal);
        }
      },
      [this](const bus::DecodeError& error) { reject(error.channel, error.reason); });
}

void PlannerNode::reject(std::string_view channel, const char* reason) {
  core_.onRejected();
  logRejection(channel, reason);
}

void PlannerNode::logRejection(std::string_view channel, const char* reason) {
  // One line for each kind: a broken sender sends hundreds a second, and the status carries the
  // count.
  if (rejections_logged_.emplace(channel, reason).second) {
    spdlog::warn("a message on {} was rejected: {}; further ones are only counted", channel,
                 reason);
  }
}

void PlannerNode::onStates(const roundabout_msgs::vehicle_states_t& message) {
  const auto begin = std::chrono::steady_clock::now();
  if (bus::fromMessage(message, frame_) > 0) {
    reject(bus::kStatesChannel, "a vehicle's state is not finite or its orientation not unit");
  }
  const core::Utime before = core_.lastFrame();
  const auto tick = core_.onFrame(frame_);
  if (core_.lastFrame() == before) {
    logRejection(bus::kStatesChannel, "its time stamp is old, or corrupt");
    return;
  }
  last_frame_ = begin;
  if (tick) {
    publish(*tick, Seconds(std::chrono::steady_clock::now() - begin).count());
  }
}

void PlannerNode::onWallClock(WallTime now) {
  const bool due = Seconds(now - last_sent_).count() >= 1.0 / settings_.rate_hz;
  if (core_.killed()) {
    if (due && Seconds(now - last_frame_) > kNotice) {
      publish(core_.killNow(), 0.0);
      last_sent_ = now;
    }
  } else if (!core_.started()) {
    if (due) {
      publishStatus(core_.waitingStatus(), 0.0);
      last_sent_ = now;
    }
  } else if (live_) {
    breakSilence(now, due);
  } else if (due && Seconds(now - last_frame_) > kNotice) {
    // So that nobody begins another flight beside a planner that is still there.
    last_status_.order_utime = core_.obeyedOrder();
    bus::publish(bus_, bus::plannerStatusChannel(core_.vehicle().name), last_status_);
    last_sent_ = now;
  }
}

void PlannerNode::breakSilence(WallTime now, bool due) {
  const double silence_s = Seconds(now - last_frame_).count();
  const double sent_s = Seconds(last_sent_ - last_frame_).count();
  // A limit that passes before the next call has passed now.
  const auto passed = [](double time_s, double limit_s) {
    return time_s + kCallPeriod.count() >= limit_s;
  };
  if (!passed(silence_s, safety_.states_hold_s)) {
    return;
  }
  const bool lands = passed(silence_s, safety_.states_land_s);
  const double limit_s = lands ? safety_.states_land_s : safety_.states_hold_s;
  // At once when a limit is passed, then at the planning rate.
  if (due || !passed(sent_s, limit_s)) {
    publish(core_.onSilence(std::max(silence_s, limit_s)), 0.0);
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
  last_status_ = toMessage(status, core_, compute_time_s);
  bus::publish(bus_, bus::plannerStatusChannel(core_.vehicle().name), last_status_);
}

void PlannerNode::logModeChange(const Status& status) {
  if (status.mode == logged_mode_ && status.reason == logged_reason_) {
    return;
  }
  const auto level = status.mode == Mode::kHolding || status.mode == Mode::kKilled
                         ? spdlog::level::warn
                         : spdlog::level::info;
  spdlog::log(level, "{}{}{}", nameOf(status.mode), status.reason.empty() ? "" : ": ",
              status.reason);
  logged_mode_ = status.mode;
  logged_reason_ = status.reason;
}

}  // namespace roundabout::planner
