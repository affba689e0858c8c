#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "common/core/frame_gate.h"
#include "common/core/laser_scan.h"
#include "common/core/planner_mode.h"
#include "common/core/tick_timer.h"
#include "common/core/vehicle_state.h"
#include "planner/policy.h"
#include "planner/safety/order_latch.h"
#include "planner/safety/room_guard.h"
#include "planner/safety/tracks.h"
#include "planner/scan_buffer.h"

namespace roundabout::planner {

using Mode = core::PlannerMode;

/// What goes into planner_status_t, except what only the node knows (compute time).
struct Status {
  core::Utime utime = 0;
  Mode mode = Mode::kWaiting;
  std::string reason;
  std::optional<core::Goal> goal;
  double distance_to_goal_m = std::numeric_limits<double>::quiet_NaN();
  Decision decision;  ///< its probabilities are valid until the next tick
  double closest_separation_m = std::numeric_limits<double>::infinity();
  int rejected_messages = 0;
  int rejected_measurements = 0;
  int missed_ticks = 0;
  double state_age_s = 0.0;
};

/// One vehicle's planner without its wires: frames, goals and orders in; on every tick one command
/// and one status out. Nothing here throws once constructed.
class PlannerCore {
 public:
  struct Tick {
    core::Command command;
    Status status;
  };

  /// Throws core::StartupError if the experiment has no such vehicle, or obstacles that the policy
  /// does not avoid.
  PlannerCore(const config::Experiment& experiment, const std::string& vehicle,
              std::unique_ptr<Policy> policy);

  /// A decoded VEHICLE_STATES. Returns a command if the frame is a planning tick.
  std::optional<Tick> onFrame(const core::StatesFrame& frame);

  /// Takes effect at the first tick after its utime. One from before this planner's first frame
  /// means that the planner was restarted during a flight: it holds until RESUME. A goal a little
  /// outside the room is moved to its edge. Returns why it was refused; nullptr: it was not.
  const char* onGoal(const core::Goal& goal);

  /// Takes effect at the next tick (or silence); KILL also at once, by killNow(). Returns why it
  /// was refused; nullptr: it was not, or it is for somebody else.
  const char* onOrder(const core::SafetyOrder& order);
  /// A sweep of the vehicle's lidar; takes effect at the first tick after its utime. Without one
  /// from the last 0.3 s a policy that needs scans does not fly: the vehicle holds. Returns why it
  /// was refused; nullptr: it was not.
  const char* onScan(const core::LaserScan& scan);
  bool needsScans() const { return policy_->needsScan(); }
  /// utime of the order obeyed last; 0: none.
  core::Utime obeyedOrder() const { return obeyed_order_; }

  /// A message that could not be decoded or was not acceptable.
  void onRejected() { ++rejected_messages_; }

  /// Live only: no frame has come for `silence_s` of wall clock, at least safety.states_hold_s.
  Tick onSilence(double silence_s);

  /// An operator has ordered KILL and not resumed.
  bool killed() const { return latch_.state() == Latch::kKill; }
  /// What a killed planner says at any time, before the first frame too.
  Tick killNow() { return report(gate_.last(), gate_.last(), {Mode::kKilled, latch_.reason()}); }

  /// Before the first frame: what the status says.
  Status waitingStatus() const;

  const config::Vehicle& vehicle() const { return experiment_.vehicles[own_index_]; }
  std::string_view policyName() const { return policy_->name(); }
  /// utime of the newest accepted frame; 0: none.
  core::Utime lastFrame() const { return gate_.last(); }
  bool started() const { return lastFrame() > 0; }

 private:
  struct Verdict {
    Mode mode;
    std::string reason;
  };

  Tick tick(core::Utime now);
  void beginAnew();
  void applyGoals(core::Utime now);
  void applyGoal(const core::Goal& goal);
  void latchFaults(core::Utime now);
  Verdict decideMode(core::Utime now);
  Verdict obeyGoal(core::Utime now);
  core::RangeScan freshScan(core::Utime now);
  Verdict land(const std::string& reason);
  std::string lostNeighbour(core::Utime now) const;
  bool inTheAir() const;
  bool atRestOnFloor() const;
  double awayFrom(const core::Goal& goal) const;  // m, horizontal
  void noteMotors(Mode mode);
  core::EgoAgent egoAgent(core::Utime now) const;
  void collectOthers(core::Utime now);
  double closestSeparation(core::Utime now) const;
  void fly(core::Utime now, core::Command& command, Status& status);
  void fillPositionCommand(const Eigen::Vector3d& target, core::Command& command) const;
  static bool finite(const core::Command& command);
  Tick report(core::Utime now, core::Utime state_utime, const Verdict& verdict);

  config::Experiment experiment_;
  std::size_t own_index_ = 0;
  std::unique_ptr<Policy> policy_;
  core::FrameGate gate_;
  TrackTable tracks_;
  core::TickTimer timer_;
  RoomGuard room_;
  OrderLatch latch_;
  core::Utime first_frame_ = 0;
  bool placed_ = false;         // the own vehicle was seen
  bool motors_on_ = false;      // as far as anybody can tell from here
  bool resumed_ = false;        // by an operator, since the first frame
  core::Utime last_order_ = 0;  // the newest
  core::Utime last_resume_ = 0;
  core::Utime obeyed_order_ = 0;  // the last to arrive
  std::vector<core::Goal> pending_goals_;
  std::optional<core::Goal> goal_;
  std::vector<core::Polygon> obstacles_;
  std::vector<core::OtherAgent> others_;
  ScanBuffer scans_;
  std::string refused_take_off_;  // why
  bool landing_done_ = false;
  int rejected_messages_ = 0;
};

}  // namespace roundabout::planner
