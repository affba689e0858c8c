#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "common/core/planner_mode.h"
#include "common/core/vehicle_state.h"

namespace roundabout::fleet {

using core::PlannerMode;

/// The latest of a planner's statuses.
struct PlannerReport {
  core::Utime utime = 0;  ///< data time; 0: it has no states yet
  PlannerMode mode = PlannerMode::kNeverHeard;
  std::int64_t goal_id = 0;
  double distance_to_goal_m = std::numeric_limits<double>::quiet_NaN();  ///< horizontal
};

/// Who is there: each vehicle with its planner, what it was told to do and how that goes.
///
/// A vehicle is *out* while its planner does not answer or has landed or killed it on its own
/// account. Vehicles are counted as in the experiment file.
class Roster {
 public:
  struct Member {
    core::VehicleState state;  ///< the last in which it was tracked
    bool seen = false;
    bool tracked = false;  ///< in the newest frame
    PlannerReport planner;
    std::optional<core::Goal> goal;
    core::Utime goal_sent = 0;
    std::string absence;  ///< why the mission goes on without it; empty: it takes part
  };

  explicit Roster(const config::Experiment& experiment);

  /// Counts from the first update() with a later utime. In lockstep every report of earlier ticks
  /// has come by then, so it does not matter who hears what a little sooner.
  void onPlanner(std::size_t vehicle, const PlannerReport& report);
  /// Who is tracked and who has said what. The frame's vehicles may come in any order; unknown ones
  /// are ignored.
  void update(const core::StatesFrame& frame);
  /// Writes down who is out; once per update() of a mission.
  void noteAbsences();
  void setGoal(std::size_t vehicle, const core::Goal& goal);
  /// A goal goes out again.
  void markSent(std::size_t vehicle, core::Utime now) { members_[vehicle].goal_sent = now; }

  std::size_t size() const { return members_.size(); }
  const Member& operator[](std::size_t vehicle) const { return members_[vehicle]; }

  /// All vehicles were seen, and all planners have states.
  bool complete() const;
  /// What complete() waits for, one line; empty: for nothing.
  std::string whatIsMissing() const;
  /// It has reported since `now` less a second.
  bool alive(std::size_t vehicle) const;
  bool everHeardOf(std::size_t vehicle) const;
  bool out(std::size_t vehicle) const;
  bool allOut() const;
  /// Takes part and holds for safety's sake.
  bool holds(std::size_t vehicle) const;
  bool onFloor(std::size_t vehicle) const;
  bool allOnFloor() const;
  /// Everybody who takes part is on the floor and has finished landing.
  bool down() const;
  /// NaN without a goal or a state.
  double distanceToGoalM(std::size_t vehicle) const;
  bool atGoal(std::size_t vehicle) const;
  /// Where it is going, or is.
  Eigen::Vector3d placeOf(std::size_t vehicle) const;
  /// Somebody landed or was killed on its own account.
  bool anybodyCameDown() const;
  /// Names and reasons, one line.
  std::string whoIsOut() const;
  std::string whoIsNotAtGoal() const;

 private:
  void takeReports();
  void takeStates(const core::StatesFrame& frame);

  const config::Experiment& experiment_;
  std::vector<Member> members_;
  std::vector<std::deque<PlannerReport>> pending_;
  core::Utime now_ = 0;
};

}  // namespace roundabout::fleet
