#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "common/bus/bus.h"
#include "common/config/experiment.h"
#include "common/core/frame_gate.h"
#include "common/core/tick_timer.h"
#include "fleet/coordinator.h"
#include "roundabout_msgs/mission_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"
#include "roundabout_msgs/vehicle_states_t.hpp"

namespace roundabout::fleet {

/// The fleet's wires: VEHICLE_STATES, PLANNER_STATUS_<vehicle> and MISSION in; on every fleet tick
/// the new and repeated GOAL_<vehicle> and then one FLEET_STATUS out. The bus's handle() drives it.
class FleetNode {
 public:
  using WallTime = std::chrono::steady_clock::time_point;

  /// Throws core::StartupError if the file's mission cannot be flown.
  FleetNode(const config::Experiment& experiment, bus::Bus& bus);
  FleetNode(const FleetNode&) = delete;
  FleetNode& operator=(const FleetNode&) = delete;

  /// Call at least every 50 ms: at the fleet's rate, announces itself before the first state and
  /// repeats its last status, with the reason, once no frame has come for more than a second.
  void onWallClock(WallTime now);

 private:
  bool knows(const std::string& vehicle) const;
  void beginAnew();
  void onStates(const roundabout_msgs::vehicle_states_t& message);
  void onPlannerStatus(std::size_t vehicle, const roundabout_msgs::planner_status_t& message);
  void onMission(const roundabout_msgs::mission_t& message);
  void reject(std::string_view channel, const std::string& reason);
  void publishStatus(const FleetStatus& status);
  void publishSilence(double silent_s);
  void logProgress(const FleetStatus& status);

  const config::Experiment& experiment_;
  bus::Bus& bus_;
  std::optional<Coordinator> coordinator_;  // always one; made anew when the states are
  core::FrameGate gate_;
  core::TickTimer timer_;
  core::StatesFrame frame_;
  std::vector<core::Utime> last_report_;
  core::Utime last_mission_ = 0;
  FleetStatus last_status_;
  bool frame_came_ = false;  // since onWallClock() looked
  bool silent_ = false;
  WallTime last_frame_seen_;
  WallTime last_announced_;
  int rejected_ = 0;
  std::map<std::string, int, std::less<>> rejected_on_;
  Phase logged_phase_ = Phase::kWaiting;
  std::string logged_text_;
};

}  // namespace roundabout::fleet
