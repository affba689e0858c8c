#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "common/core/frame_gate.h"
#include "common/core/laser_scan.h"
#include "common/core/sensor_data.h"
#include "common/core/tick_timer.h"
#include "common/core/vehicle_state.h"
#include "planner/flight_shield.h"
#include "planner/goal_queue.h"
#include "planner/mode_machine.h"
#include "planner/pilot.h"
#include "planner/policy.h"
#include "planner/safety/order_book.h"
#include "planner/safety/room_guard.h"
#include "planner/safety/seen_agents.h"
#include "planner/safety/tracks.h"
#include "planner/situation.h"
#include "planner/status.h"

namespace roundabout::planner {

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
  bool needsScans() const { return pilot_.needsScans(); }
  /// What the vehicle's perception sees; takes effect at the first tick after its utime. With
  /// planner.others tracks or both, without tracks from the last safety.tracks_hold_s the vehicle
  /// holds. Returns why the message was refused; nullptr: it was not.
  const char* onTracks(const core::AgentTracks& tracks);
  bool needsTracks() const { return seen_.used(); }
  /// What another vehicle's planner commands; takes effect at the first tick after its utime.
  /// Returns why it was refused; nullptr: it was not.
  const char* onOthersCommand(const core::Command& command);
  /// utime of the order obeyed last; 0: none.
  core::Utime obeyedOrder() const { return orders_.obeyed(); }

  /// A message that could not be decoded or was not acceptable.
  void onRejected() { ++rejected_messages_; }

  /// What perception knows of the world that does not move; takes effect at the first tick after
  /// its utime. Returns why it was refused; nullptr: it was not.
  const char* onMap(const core::OccupancyMap& map);

  /// Live only: no frame has come for `silence_s` of wall clock, at least safety.states_hold_s.
  Tick onSilence(double silence_s);

  /// An operator has ordered KILL and not resumed.
  bool killed() const { return modes_.killed(); }
  /// What a killed planner says at any time, before the first frame too.
  Tick killNow() {
    return report(gate_.last(), gate_.last(), {Mode::kKilled, modes_.latch().reason()});
  }

  /// Before the first frame: what the status says.
  Status waitingStatus() const;

  const config::Experiment& experiment() const { return experiment_; }
  const config::Vehicle& vehicle() const { return experiment_.vehicles[own_index_]; }
  std::string_view policyName() const { return pilot_.policyName(); }
  /// utime of the newest accepted frame; 0: none.
  core::Utime lastFrame() const { return gate_.last(); }
  bool started() const { return lastFrame() > 0; }

 private:
  Tick tick(core::Utime now);
  void noteGap(core::Utime before, core::Utime now);
  void beginAnew();
  void applyGoals(core::Utime now);
  Sight sight(core::Utime now);
  Situation situation() const { return {experiment_, own_index_, tracks_, seen_}; }
  void fill(core::Utime now, core::Command& command, Status& status);
  void limitValidity(core::Utime now, core::Command& command) const;
  void stopUnlessFinite(core::Command& command, Status& status);
  Tick report(core::Utime now, core::Utime state_utime, const Verdict& verdict);

  config::Experiment experiment_;
  std::size_t own_index_ = 0;
  core::FrameGate gate_;
  TrackTable tracks_;
  SeenAgents seen_;
  core::TickTimer timer_;
  RoomGuard room_;
  OrderBook orders_;
  GoalQueue goals_;
  ModeMachine modes_;
  Pilot pilot_;
  FlightShield shield_;
  core::Utime first_frame_ = 0;
  int rejected_messages_ = 0;
  int ticks_without_tracks_ = 0;
};

}  // namespace roundabout::planner
