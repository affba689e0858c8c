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
#include "fleet/assignment.h"
#include "fleet/mission.h"

namespace roundabout::fleet {

/// As in lcmtypes/fleet_status_t.lcm.
enum class Phase : std::int8_t {
  kWaiting = 0,
  kIdle = 1,
  kTakeOff = 2,
  kGo = 3,
  kHold = 4,
  kLand = 5,
  kDone = 6,
  kFailed = 7
};

using core::PlannerMode;

/// The latest of a planner's statuses.
struct PlannerReport {
  core::Utime utime = 0;  ///< data time; 0: it has no states yet
  PlannerMode mode = PlannerMode::kNeverHeard;
  std::int64_t goal_id = 0;
  double distance_to_goal_m = std::numeric_limits<double>::quiet_NaN();  ///< horizontal
};

struct Progress {
  std::optional<core::Goal> goal;
  double distance_m = 0.0;  ///< NaN without a goal
  bool at_goal = false;
  bool planner_alive = false;
  PlannerMode planner_mode = PlannerMode::kNeverHeard;
};

struct FleetStatus {
  core::Utime utime = 0;
  Phase phase = Phase::kWaiting;
  std::string formation;
  int step = -1;
  int num_steps = 0;
  int vehicles_at_goal = 0;
  std::string reason;
  std::vector<Progress> vehicles;
  std::vector<std::string> refusals;
};

/// Flies a mission with a fleet: decides who goes where, when a step is done, and what to do when
/// it is not. No wires, no clock but the frames'.
///
/// Steps of the file's mission have goal ids (k + 1) * 1000 + vehicle, so that a fleet process that
/// was restarted during a flight learns from the planners where it was. A vehicle is *out* while
/// its planner does not answer or has landed or killed it on its own account: the mission goes on
/// without it. A mission that ends with a vehicle landed or killed that way has failed. While a
/// vehicle holds for safety's sake, time-outs stand still.
class Coordinator {
 public:
  struct Output {
    std::vector<core::Goal> goals;  ///< to publish, before the status
    FleetStatus status;
  };

  /// Throws core::StartupError if the file's mission cannot be flown.
  explicit Coordinator(const config::Experiment& experiment);

  /// Takes effect at the first tick 0.15 s after its utime, so that it does not matter who hears
  /// what a little sooner.
  void onPlanner(std::size_t vehicle, const PlannerReport& report);

  /// A live mission step, looked at on the next tick. Hold and land then take effect at once and
  /// drop what is queued; the rest waits for its turn.
  void onMission(std::int64_t mission_id, const config::MissionStep& asked);
  /// A mission message that could not be read.
  void refuse(std::int64_t mission_id, const std::string& reason);

  /// One fleet tick. The frame's vehicles may come in any order; unknown ones are ignored.
  Output tick(const core::StatesFrame& frame);

  /// Before the first frame.
  FleetStatus waitingStatus() const;

 private:
  struct Member {
    core::VehicleState state;  ///< the last in which it was tracked
    bool seen = false;
    bool tracked = false;  ///< in the newest frame
    std::string absence;   ///< why the mission goes on without it; empty: it takes part
    std::optional<core::Goal> goal;
    core::Utime goal_sent = 0;
  };

  struct Asked {
    std::int64_t mission_id;
    config::MissionStep step;
  };
  struct Queued {
    std::int64_t mission_id = 0;
    Step step;
  };

  void applyReports(core::Utime now);
  void applyFrame(const core::StatesFrame& frame);
  void repeatGoals(core::Utime now);
  bool everybodyIsThere() const;
  void start(core::Utime now);
  void takeOver(core::Utime now, std::int64_t known_id);
  void takeMissions(core::Utime now);
  void take(core::Utime now, const Asked& asked);
  void finish();
  void advance(core::Utime now);
  void next(core::Utime now);
  void begin(core::Utime now);
  void fail(core::Utime now, const std::string& reason);
  void checkStep(core::Utime now);

  void sendAllUp(core::Utime now);
  void sendToFormation(core::Utime now);
  Assignment assign(const Step& formation) const;
  Assignment assignAsReported(const Step& formation) const;
  Eigen::Vector3d placeOf(std::size_t vehicle) const;
  void stay(core::Utime now);
  void sendAllDown(core::Utime now);
  void setGoal(core::Utime now, std::size_t vehicle, core::GoalPhase phase,
               const Eigen::Vector3d& position_m);
  std::optional<std::string> cannotBegin(const Step& step) const;
  std::optional<std::string> tooClose(std::size_t standing, const Eigen::Vector3d& point_m) const;
  bool complete(core::Utime now) const;
  bool down(core::Utime now) const;

  const Step& step() const { return live_ ? live_step_.step : file_steps_[index_]; }
  std::int64_t goalId(std::size_t vehicle) const;
  bool alive(std::size_t vehicle, core::Utime now) const;
  bool out(std::size_t vehicle, core::Utime now) const;
  void noteAbsence(core::Utime now);
  std::string whoIsOut() const;
  std::string whoIsMissing() const;
  bool holding(std::size_t vehicle) const;
  bool onFloor(std::size_t vehicle) const;
  bool allOnFloor() const;
  double distanceToGoal(std::size_t vehicle) const;
  bool atGoal(std::size_t vehicle) const;
  FleetStatus status(core::Utime now) const;

  const config::Experiment& experiment_;
  MissionReader reader_;
  std::vector<Step> file_steps_;
  std::deque<Queued> queue_;  // of live steps
  std::vector<Asked> asked_;  // since the last tick
  std::vector<Member> members_;
  std::vector<PlannerReport> planners_;
  std::vector<std::deque<PlannerReport>> pending_reports_;
  std::vector<core::Goal> outbox_;
  std::deque<std::string> refusals_;

  Phase phase_ = Phase::kWaiting;
  bool live_ = false;  // the current step came by message
  Queued live_step_;
  bool resuming_ = false;  // the current step began before this process did
  std::int64_t live_count_ = 0;
  std::size_t index_ = 0;  // of the file's step
  bool file_finished_ = false;
  core::Utime last_tick_ = 0;
  core::Utime tick_time_ = 0;    // data time since the last tick
  core::Utime step_time_ = 0;    // without the time in which a vehicle held
  core::Utime formed_time_ = 0;  // since the formation was complete
  std::string failure_;
};

}  // namespace roundabout::fleet
