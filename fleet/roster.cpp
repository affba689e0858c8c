#include "fleet/roster.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace roundabout::fleet {

namespace {

constexpr double kPlannerSilent_s = 1.0;
// More than a planner can send between two ticks, even after the fleet was away for a while.
constexpr std::size_t kReportsKept = 100;
constexpr const char* kSilent = "planner silent";

const char* separator(const std::string& text) { return text.empty() ? "" : ", "; }

}  // namespace

Roster::Roster(const config::Experiment& experiment)
    : experiment_(experiment),
      members_(experiment.vehicles.size()),
      pending_(experiment.vehicles.size()) {}

void Roster::onPlanner(std::size_t vehicle, const PlannerReport& report) {
  std::deque<PlannerReport>& pending = pending_[vehicle];
  pending.push_back(report);
  if (pending.size() > kReportsKept) {
    pending.pop_front();
  }
}

void Roster::update(const core::StatesFrame& frame) {
  now_ = frame.utime;
  takeStates(frame);
  takeReports();
}

void Roster::takeStates(const core::StatesFrame& frame) {
  for (Member& member : members_) {
    member.tracked = false;
  }
  for (const core::VehicleState& state : frame.vehicles) {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (state.tracked && experiment_.vehicles[i].name == state.name) {
        members_[i].state = state;
        members_[i].seen = true;
        members_[i].tracked = true;
      }
    }
  }
}

void Roster::takeReports() {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    while (!pending_[i].empty() && pending_[i].front().utime < now_) {
      members_[i].planner = pending_[i].front();
      pending_[i].pop_front();
    }
  }
}

void Roster::noteAbsences() {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    const bool lands = member.goal && member.goal->phase == core::GoalPhase::kLand;
    if (!out(i)) {
      // Once all land, who takes part can no longer be told: what was known before stands.
      member.absence = lands ? member.absence : "";
    } else if (member.absence.empty() || !lands) {
      member.absence = !alive(i)                                     ? kSilent
                       : member.planner.mode == PlannerMode::kKilled ? "killed"
                                                                     : "came down";
    }
  }
}

void Roster::setGoal(std::size_t vehicle, const core::Goal& goal) {
  members_[vehicle].goal = goal;
  members_[vehicle].goal_sent = goal.utime;
}

bool Roster::complete() const {
  return std::all_of(members_.begin(), members_.end(),
                     [](const Member& member) { return member.seen && member.planner.utime > 0; });
}

std::string Roster::whatIsMissing() const {
  std::string text;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const char* what = !everHeardOf(i) ? "'s planner" : !members_[i].seen ? "'s state" : nullptr;
    if (what != nullptr) {
      text += separator(text) + experiment_.vehicles[i].name + what;
    }
  }
  return text;
}

bool Roster::alive(std::size_t vehicle) const {
  const PlannerReport& planner = members_[vehicle].planner;
  return planner.utime > 0 && core::toSeconds(now_ - planner.utime) <= kPlannerSilent_s;
}

bool Roster::everHeardOf(std::size_t vehicle) const {
  return members_[vehicle].planner.utime > 0 || !pending_[vehicle].empty();
}

bool Roster::out(std::size_t vehicle) const {
  if (!alive(vehicle)) {
    return true;
  }
  const Member& member = members_[vehicle];
  const PlannerMode mode = member.planner.mode;
  if (mode == PlannerMode::kKilled) {
    return true;
  }
  if (!member.goal || member.planner.goal_id != member.goal->goal_id) {
    return false;
  }
  const bool comes_down = mode == PlannerMode::kLanding || mode == PlannerMode::kLanded;
  switch (member.goal->phase) {
    case core::GoalPhase::kTakeOff:
      return comes_down;
    case core::GoalPhase::kGo:
      return comes_down || onFloor(vehicle);
    case core::GoalPhase::kLand:
      break;
  }
  return false;
}

bool Roster::allOut() const {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (!out(i)) {
      return false;
    }
  }
  return true;
}

bool Roster::holds(std::size_t vehicle) const {
  return !out(vehicle) && members_[vehicle].planner.mode == PlannerMode::kHolding;
}

bool Roster::onFloor(std::size_t vehicle) const {
  const double height_m = members_[vehicle].state.position_world_m.z();
  const PlannerMode mode = members_[vehicle].planner.mode;
  return config::flies(experiment_.vehicles[vehicle])
             ? height_m <= experiment_.safety.airborne_height_m
             : mode == PlannerMode::kLanded || mode == PlannerMode::kKilled;
}

bool Roster::allOnFloor() const {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (!onFloor(i)) {
      return false;
    }
  }
  return true;
}

bool Roster::down() const {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const bool landed = onFloor(i) && members_[i].planner.mode != PlannerMode::kLanding;
    if (!landed && !out(i)) {
      return false;
    }
  }
  return true;
}

double Roster::distanceToGoalM(std::size_t vehicle) const {
  const Member& member = members_[vehicle];
  if (!member.goal || !member.seen) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Eigen::Vector3d way = member.goal->position_world_m - member.state.position_world_m;
  return config::flies(experiment_.vehicles[vehicle]) ? way.norm() : way.head<2>().norm();
}

bool Roster::atGoal(std::size_t vehicle) const {
  const Member& member = members_[vehicle];
  return member.tracked && distanceToGoalM(vehicle) <= experiment_.fleet.at_goal_distance_m &&
         member.state.velocity_world_mps.norm() <= experiment_.fleet.at_goal_speed_mps;
}

Eigen::Vector3d Roster::placeOf(std::size_t vehicle) const {
  const Member& member = members_[vehicle];
  return member.goal ? member.goal->position_world_m : member.state.position_world_m;
}

bool Roster::anybodyCameDown() const {
  return std::any_of(members_.begin(), members_.end(), [](const Member& member) {
    return !member.absence.empty() && member.absence != kSilent;
  });
}

std::string Roster::whoIsOut() const {
  std::string text;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (!members_[i].absence.empty()) {
      text += fmt::format("{}{} ({})", separator(text), experiment_.vehicles[i].name,
                          members_[i].absence);
    }
  }
  return text;
}

std::string Roster::whoIsNotAtGoal() const {
  std::string text;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (!atGoal(i)) {
      text += fmt::format("{}{} is {:.2f} m from its goal", separator(text),
                          experiment_.vehicles[i].name, distanceToGoalM(i));
    }
  }
  return text;
}

}  // namespace roundabout::fleet
