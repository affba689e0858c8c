#include "cli/flight_director.h"

#include <utility>

namespace roundabout::cli {

FlightDirector::FlightDirector(std::vector<std::string> vehicles, DirectorLimits limits)
    : limits_(limits) {
  for (std::string& vehicle : vehicles) {
    vehicles_.emplace(std::move(vehicle), VehicleView());
  }
}

void FlightDirector::onEnd(Role role, const std::string& vehicle, bool clean, double now_s) {
  switch (role) {
    case Role::kSim:
      sim_finished_ = clean;
      if (!clean) {
        sim_death_s_ = now_s;
        reason_ = "the simulator died";
        early_ = true;
      }
      break;
    case Role::kFleet:
      fleet_death_s_ = now_s;
      break;
    case Role::kPlanner:
      vehicles_.at(vehicle).planner_death_s = now_s;
      break;
    case Role::kPerception:
      break;  // its vehicle's planner holds by itself
    case Role::kLogger:
      land("the logger died");
      break;
    case Role::kMocap:
      land("motion capture ended");
      break;
  }
}

void FlightDirector::onFleetHeard(double now_s) {
  if (fleet_death_s_ && now_s - *fleet_death_s_ > kEcho_s) {
    fleet_death_s_.reset();
  }
}

void FlightDirector::onPlannerHeard(const std::string& vehicle, bool on_floor, double now_s) {
  VehicleView& view = vehicles_.at(vehicle);
  view.on_floor = on_floor;
  if (view.planner_death_s && now_s - *view.planner_death_s > kEcho_s) {
    view.planner_death_s.reset();
  }
}

void FlightDirector::onStop() { land("stopped by the user"); }

void FlightDirector::onMissionOver() {
  land("the mission is over and does not end with land", false);
}

void FlightDirector::onFleetDone() { sim_finished_ = true; }

void FlightDirector::onFailure(const std::string& what) { land("roundabout fly failed: " + what); }

Direction FlightDirector::decide(double now_s) {
  if (sim_finished_ || (landing_ && !flying_)) {
    return Direction::kEnd;
  }
  if (sim_death_s_) {
    return now_s - *sim_death_s_ < limits_.sim_linger_s ? Direction::kGoOn : Direction::kEnd;
  }
  if (fleet_death_s_ && now_s - *fleet_death_s_ >= limits_.fleet_return_s) {
    land("no new fleet took over");
  }
  if (!landing_) {
    return Direction::kGoOn;
  }
  if (!landing_since_s_) {
    landing_since_s_ = now_s;
    return Direction::kLand;
  }
  std::vector<std::string> in_the_air = inTheAir();
  if (in_the_air.empty()) {
    return Direction::kEnd;
  }
  if (now_s - *landing_since_s_ < limits_.landing_s) {
    return Direction::kLand;
  }
  not_landed_ = std::move(in_the_air);
  return Direction::kEnd;
}

std::vector<std::string> FlightDirector::inTheAir() const {
  std::vector<std::string> names;
  for (const auto& [name, vehicle] : vehicles_) {
    if (!vehicle.on_floor && !vehicle.planner_death_s) {
      names.push_back(name);
    }
  }
  return names;
}

void FlightDirector::land(const std::string& reason, bool early) {
  if (!landing_) {
    landing_ = true;
    early_ = early;
    reason_ = reason;
  }
}

}  // namespace roundabout::cli
