#include "cli/flight_monitor.h"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/fleet_phase.h"
#include "roundabout_msgs/mission_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::cli {

namespace {

using roundabout_msgs::fleet_status_t;
using roundabout_msgs::planner_status_t;

bool onFloor(std::int8_t mode) {
  // WAITING has no goal yet, so it has not taken off.
  return mode == planner_status_t::WAITING || mode == planner_status_t::ON_FLOOR ||
         mode == planner_status_t::LANDED || mode == planner_status_t::KILLED;
}

// What is not a message of its type is the flight's processes' to count.
void ignore(const bus::DecodeError& /*error*/) {}

}  // namespace

FlightMonitor::FlightMonitor(bus::Bus& bus, const config::Experiment& experiment, Events events)
    : events_(std::move(events)) {
  progress_.vehicles = experiment.vehicles.size();
  progress_.fleet.phase = fleet_status_t::WAITING;
  bus::subscribe<roundabout_msgs::vehicle_states_t>(
      bus, bus::kStatesChannel,
      [this](const roundabout_msgs::vehicle_states_t& message) {
        bus::fromMessage(message, frame_);
        onFrame(frame_);
      },
      ignore);
  bus::subscribe<fleet_status_t>(
      bus, bus::kFleetStatusChannel,
      [this](const fleet_status_t& message) {
        progress_.fleet = message;
        events_.fleet_heard();
      },
      ignore);
  bus::subscribe<roundabout_msgs::mission_t>(
      bus, bus::kMissionChannel,
      [this](const roundabout_msgs::mission_t&) { steered_by_message_ = true; }, ignore);
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    body_radius_m_[vehicle.name] = vehicle.body_radius_m;
    bus::subscribe<planner_status_t>(
        bus, bus::plannerStatusChannel(vehicle.name),
        [this, name = vehicle.name](const planner_status_t& message) {
          events_.planner_heard(name, onFloor(message.mode));
        },
        ignore);
  }
}

bool FlightMonitor::missionOver() const {
  return progress_.fleet.phase == fleet_status_t::IDLE && progress_.fleet.num_steps > 0 &&
         !steered_by_message_;
}

bool FlightMonitor::missionEnded() const {
  return progress_.fleet.phase == fleet_status_t::DONE ||
         progress_.fleet.phase == fleet_status_t::FAILED;
}

void FlightMonitor::onFrame(const core::StatesFrame& frame) {
  const core::FrameVerdict verdict = gate_.judge(frame.utime);
  if (verdict == core::FrameVerdict::kRefused) {
    return;
  }
  if (progress_.first_utime == 0) {
    progress_.first_utime = frame.utime;
    events_.first_state();
  }
  if (verdict == core::FrameVerdict::kNewEpoch) {
    progress_.first_utime = frame.utime;
  }
  progress_.last_utime = frame.utime;
  for (auto a = frame.vehicles.begin(); a != frame.vehicles.end(); ++a) {
    const auto radius_a = body_radius_m_.find(a->name);
    if (!a->tracked || radius_a == body_radius_m_.end()) {
      continue;
    }
    for (auto b = a + 1; b != frame.vehicles.end(); ++b) {
      const auto radius_b = body_radius_m_.find(b->name);
      if (!b->tracked || radius_b == body_radius_m_.end()) {
        continue;
      }
      const double distance_m = (a->position_world_m - b->position_world_m).head<2>().norm();
      progress_.closest_separation_m = std::min(progress_.closest_separation_m,
                                                distance_m - radius_a->second - radius_b->second);
    }
  }
}

std::string describe(const Progress& progress, double wall_s) {
  const fleet_status_t& fleet = progress.fleet;
  std::string text = core::nameOf(static_cast<core::FleetPhase>(fleet.phase));
  if (!fleet.formation.empty()) {
    text += " " + fleet.formation;
  }
  if (fleet.step >= 0) {
    text += fmt::format(" (step {} of {})", fleet.step + 1, fleet.num_steps);
  }
  text += fmt::format(", {} of {} at goal", fleet.vehicles_at_goal, progress.vehicles);
  if (progress.closest_separation_m < std::numeric_limits<double>::infinity()) {
    text += fmt::format(", closest {:.2f} m", progress.closest_separation_m);
  }
  text += fmt::format(", {:.1f} s", progress.elapsed_s());
  if (wall_s > 0.0) {
    text += fmt::format(", {:.1f}x real time", progress.elapsed_s() / wall_s);
  }
  return text;
}

}  // namespace roundabout::cli
