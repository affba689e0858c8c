#include "fleet/fleet_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <spdlog/spdlog.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/fleet_status_t.hpp"

namespace roundabout::fleet {

namespace {

using Seconds = std::chrono::duration<double>;

// Longer than a simulator in lockstep waits for a tick's answers, but for a planner that died.
constexpr double kStatesSilent_s = 1.0;

roundabout_msgs::fleet_status_t toMessage(const FleetStatus& status,
                                          const config::Experiment& experiment, int rejected) {
  roundabout_msgs::fleet_status_t message;
  message.utime = status.utime;
  message.num_vehicles = static_cast<std::int32_t>(status.vehicles.size());
  for (std::size_t i = 0; i < status.vehicles.size(); ++i) {
    const Progress& progress = status.vehicles[i];
    roundabout_msgs::vehicle_progress_t out;
    out.vehicle = experiment.vehicles[i].name;
    out.goal_id = progress.goal ? progress.goal->goal_id : 0;
    for (int axis = 0; axis < 3; ++axis) {
      out.goal[axis] = progress.goal ? progress.goal->position_world_m[axis]
                                     : std::numeric_limits<double>::quiet_NaN();
    }
    out.distance = progress.distance_m;
    out.at_goal = progress.at_goal ? 1 : 0;
    out.planner_alive = progress.planner_alive ? 1 : 0;
    out.planner_mode = static_cast<std::int8_t>(progress.planner_mode);
    message.vehicles.push_back(out);
  }
  message.num_refusals = static_cast<std::int32_t>(status.refusals.size());
  message.refusals = status.refusals;
  message.phase = static_cast<std::int8_t>(status.phase);
  message.formation = status.formation;
  message.step = status.step;
  message.num_steps = status.num_steps;
  message.vehicles_at_goal = status.vehicles_at_goal;
  message.mission_id = status.mission_id;
  message.newest_mission_id = status.newest_mission_id;
  message.finished_mission_id = status.finished_mission_id;
  message.reason = status.reason;
  message.rejected_messages = rejected;
  return message;
}

}  // namespace

FleetNode::FleetNode(const config::Experiment& experiment, bus::Bus& bus)
    : experiment_(experiment),
      bus_(bus),
      coordinator_(std::in_place, experiment),
      timer_(experiment.fleet.rate_hz),
      last_report_(experiment.vehicles.size(), 0) {
  last_status_ = coordinator_->waitingStatus();
  const auto on_error = [this](const bus::DecodeError& error) {
    reject(error.channel, error.reason);
  };
  bus::subscribe<roundabout_msgs::vehicle_states_t>(
      bus_, bus::kStatesChannel,
      [this](const roundabout_msgs::vehicle_states_t& message) { onStates(message); }, on_error);
  bus::subscribe<roundabout_msgs::mission_t>(
      bus_, bus::kMissionChannel,
      [this](const roundabout_msgs::mission_t& message) { onMission(message); }, on_error);
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    bus::subscribe<roundabout_msgs::planner_status_t>(
        bus_, bus::plannerStatusChannel(experiment.vehicles[i].name),
        [this, i](const roundabout_msgs::planner_status_t& message) {
          onPlannerStatus(i, message);
        },
        on_error);
  }
}

void FleetNode::reject(std::string_view channel, const std::string& reason) {
  ++rejected_;
  const auto known = rejected_on_.find(channel);
  if (known == rejected_on_.end()) {
    rejected_on_.emplace(channel, 1);
    spdlog::warn("a message on {} was rejected: {}; further ones are only counted", channel,
                 reason);
  } else {
    ++known->second;
  }
}

bool FleetNode::knows(const std::string& vehicle) const {
  return std::any_of(experiment_.vehicles.begin(), experiment_.vehicles.end(),
                     [&](const config::Vehicle& known) { return known.name == vehicle; });
}

void FleetNode::onStates(const roundabout_msgs::vehicle_states_t& message) {
  if (bus::fromMessage(message, frame_) > 0) {
    reject(bus::kStatesChannel, "a vehicle's state is not finite or its orientation not unit");
  }
  for (const core::VehicleState& state : frame_.vehicles) {
    if (!knows(state.name)) {
      reject(bus::kStatesChannel, "a vehicle that the experiment does not have");
    }
  }
  switch (gate_.judge(frame_.utime)) {
    case core::FrameVerdict::kRefused:
      reject(bus::kStatesChannel, "its time stamp is old, or corrupt");
      return;
    case core::FrameVerdict::kNewEpoch:
      beginAnew();
      break;
    case core::FrameVerdict::kAccepted:
      break;
  }
  frame_came_ = true;
  if (!timer_.due(frame_.utime)) {
    return;
  }
  const Coordinator::Output output = coordinator_->tick(frame_);
  for (const core::Goal& goal : output.goals) {
    bus::publish(bus_, bus::goalChannel(goal.vehicle), bus::toMessage(goal));
  }
  last_status_ = output.status;
  publishStatus(last_status_);
}

void FleetNode::beginAnew() {
  spdlog::warn("the time of the vehicle states went back: the mission begins anew");
  coordinator_.emplace(experiment_);
  timer_ = core::TickTimer(experiment_.fleet.rate_hz);
  std::fill(last_report_.begin(), last_report_.end(), 0);
  last_status_ = coordinator_->waitingStatus();
}

void FleetNode::onPlannerStatus(std::size_t vehicle,
                                const roundabout_msgs::planner_status_t& message) {
  const std::string& name = experiment_.vehicles[vehicle].name;
  if (message.vehicle != name || message.mode < roundabout_msgs::planner_status_t::WAITING ||
      message.mode > roundabout_msgs::planner_status_t::KILLED || message.utime < 0) {
    reject(bus::plannerStatusChannel(name), "of another vehicle, or an unknown mode");
    return;
  }
  if (gate_.last() > 0 && message.utime - gate_.last() > core::kFarAhead) {
    reject(bus::plannerStatusChannel(name), "far ahead of the vehicle states");
    return;
  }
  // utime 0: it has just started and has no states yet.
  if (message.utime > 0 && message.utime < last_report_[vehicle]) {
    reject(bus::plannerStatusChannel(name), "older than the last one");
    return;
  }
  last_report_[vehicle] = message.utime;
  coordinator_->onPlanner(vehicle, {message.utime, static_cast<PlannerMode>(message.mode),
                                    message.goal_id, message.distance_to_goal});
}

void FleetNode::onMission(const roundabout_msgs::mission_t& message) {
  // What makes the fleet safer is obeyed whatever its stamp.
  if (message.utime < last_mission_ && message.verb != "hold" && message.verb != "land") {
    reject(bus::kMissionChannel, "older than the last one");
    coordinator_->refuse(message.mission_id, "older than the mission before it");
    return;
  }
  last_mission_ = std::max(last_mission_, message.utime);
  config::MissionStep asked;
  asked.verb = message.verb;
  asked.text = message.text;
  asked.vehicle = message.vehicle;
  asked.seconds = std::isnan(message.seconds) ? -1.0 : message.seconds;
  for (const auto& point : message.points) {
    asked.points_m.emplace_back(point[0], point[1], point[2]);
  }
  spdlog::info("mission {}: {} {}{}", message.mission_id, asked.verb, asked.text, asked.vehicle);
  coordinator_->onMission(message.mission_id, asked);
}

void FleetNode::onWallClock(WallTime now) {
  if (frame_came_) {
    frame_came_ = false;
    silent_ = false;
    last_frame_seen_ = now;
  }
  const double silent_s = Seconds(now - last_frame_seen_).count();
  const bool alone = gate_.last() == 0 || silent_s > kStatesSilent_s;
  if (!alone || Seconds(now - last_announced_).count() < 1.0 / experiment_.fleet.rate_hz) {
    return;
  }
  last_announced_ = now;
  if (gate_.last() == 0) {
    publishStatus(coordinator_->waitingStatus());
  } else {
    publishSilence(silent_s);
  }
}

void FleetNode::publishSilence(double silent_s) {
  if (!silent_) {
    silent_ = true;
    spdlog::warn("no vehicle states for {:.0f} s", silent_s);
  }
  FleetStatus status = last_status_;
  status.reason = fmt::format("no vehicle states for {:.0f} s{}{}", silent_s,
                              status.reason.empty() ? "" : "; ", status.reason);
  bus::publish(bus_, bus::kFleetStatusChannel, toMessage(status, experiment_, rejected_));
}

void FleetNode::publishStatus(const FleetStatus& status) {
  logProgress(status);
  bus::publish(bus_, bus::kFleetStatusChannel, toMessage(status, experiment_, rejected_));
}

void FleetNode::logProgress(const FleetStatus& status) {
  const std::string text = status.formation + "|" + status.reason;
  if (status.phase == logged_phase_ && text == logged_text_) {
    return;
  }
  const bool bad = status.phase == Phase::kFailed;
  spdlog::log(bad ? spdlog::level::err : spdlog::level::info, "{}{}{}{}{}", nameOf(status.phase),
              status.formation.empty() ? "" : " ", status.formation,
              status.reason.empty() ? "" : ": ", status.reason);
  logged_phase_ = status.phase;
  logged_text_ = text;
}

}  // namespace roundabout::fleet
