#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "common/core/fleet_phase.h"
#include "common/core/vehicle_state.h"
#include "fleet/assignment.h"
#include "fleet/mission.h"
#include "fleet/roster.h"

namespace roundabout::fleet {

using Phase = core::FleetPhase;

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
  std::int64_t mission_id = 0;  ///< of the message whose step is being flown; 0: none
  std::int64_t newest_mission_id = 0;
  std::int64_t finished_mission_id = 0;
  std::string reason;
  std::vector<Progress> vehicles;
  std::vector<std::string> refusals;
};

/// Flies a mission with a fleet: decides who goes where, when a step is done, and what to do when
/// it is not. No wires, no clock but the frames'.
///
/// Steps of the file's mission have goal ids (k + 1) * 1000 + vehicle, so that a fleet process that
/// was restarted during a flight learns from the planners where it was. The mission goes on without
/// a vehicle that is out (Roster). A mission that ends with a vehicle landed or killed on its own
/// account has failed. While a vehicle holds for safety's sake, time-outs stand still.
class Coordinator {
 public:
  struct Output {
    std::vector<core::Goal> goals;  ///< to publish, before the status
    FleetStatus status;
  };

  /// Throws core::StartupError if the file's mission cannot be flown.
  explicit Coordinator(const config::Experiment& experiment);

  /// Takes effect at the first tick with a later utime.
  void onPlanner(std::size_t vehicle, const PlannerReport& report) {
    roster_.onPlanner(vehicle, report);
  }

  /// A live mission step, looked at on the next tick. Hold and land then take effect at once and
  /// drop what is queued; go_on ends a wait_until go_on; the rest waits for its turn.
  void onMission(std::int64_t mission_id, const config::MissionStep& asked);
  /// A mission message that could not be read.
  void refuse(std::int64_t mission_id, const std::string& reason);

  /// One fleet tick. The frame's vehicles may come in any order; unknown ones are ignored.
  Output tick(const core::StatesFrame& frame);

  /// Before the first frame.
  FleetStatus waitingStatus() const;

 private:
  struct Asked {
    std::int64_t mission_id;
    config::MissionStep step;
  };
  struct Queued {
    std::int64_t mission_id = 0;
    Step step;
  };

  void repeatGoals(core::Utime now);
  void start(core::Utime now);
  void takeOver(core::Utime now, std::int64_t known_id);
  void takeMissions(core::Utime now);
  void take(core::Utime now, const Asked& asked);
  void goOn(core::Utime now, std::int64_t mission_id);
  bool waitsFor(Event event) const;
  void finish();
  void drop(const std::string& why);
  void stepDone(core::Utime now);
  void advance(core::Utime now);
  void next(core::Utime now);
  void begin(core::Utime now);
  void fail(core::Utime now, const std::string& reason);
  void checkStep(core::Utime now);

  void sendAllUp(core::Utime now);
  Eigen::Vector3d placeAbove(std::size_t vehicle) const;
  void sendToFormation(core::Utime now);
  Assignment assign(const Step& formation) const;
  Assignment assignAsReported(const Step& formation) const;
  void stay(core::Utime now);
  void sendAllDown(core::Utime now);
  void setGoal(core::Utime now, std::size_t vehicle, core::GoalPhase phase,
               const Eigen::Vector3d& position_m);
  std::optional<std::string> cannotBegin(const Step& step) const;
  std::optional<std::string> tooCloseToTakeOff() const;
  std::optional<std::string> tooClose(std::size_t standing, const Eigen::Vector3d& point_m) const;
  bool complete() const;

  const Step& step() const { return live_ ? live_step_.step : file_steps_[index_]; }
  std::int64_t goalId(std::size_t vehicle) const;
  FleetStatus status(core::Utime now) const;
  bool stepping() const;

  const config::Experiment& experiment_;
  Roster roster_;
  MissionReader reader_;
  std::vector<Step> file_steps_;
  std::deque<Queued> queue_;  // of live steps
  std::vector<Asked> asked_;  // since the last tick
  std::vector<core::Goal> outbox_;
  std::deque<std::string> refusals_;
  std::int64_t newest_mission_ = 0;
  std::int64_t finished_mission_ = 0;

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
  core::Utime took_off_ = 0;     // when the last take-off began, or this process
  std::string failure_;
};

}  // namespace roundabout::fleet
