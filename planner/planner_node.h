#pragma once

#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "common/bus/bus.h"
#include "common/config/experiment.h"
#include "planner/planner_core.h"
#include "roundabout_msgs/planner_status_t.hpp"
#include "roundabout_msgs/vehicle_states_t.hpp"

namespace roundabout::planner {

/// True for a planner that lives in real time: silence then means that something is wrong. In
/// lockstep the simulator may wait for anybody for as long as it likes.
bool watchesWallClock(const config::Experiment& experiment);

/// The planner's wires: VEHICLE_STATES, GOAL_<vehicle>, SAFETY_ORDER, the other planners'
/// COMMAND_<vehicle>, AGENT_TRACKS_ and OCCUPANCY_<vehicle> if it goes by what it sees, and
/// LASER_SCAN_<vehicle> if its policy needs scans in, COMMAND_<vehicle> and
/// PLANNER_STATUS_<vehicle> out. The bus's handle() drives it; onWallClock() tells it how time
/// passes when no message comes.
class PlannerNode {
 public:
  using WallTime = std::chrono::steady_clock::time_point;

  /// Throws core::StartupError if the experiment has no such vehicle.
  PlannerNode(const config::Experiment& experiment, const std::string& vehicle,
              std::unique_ptr<Policy> policy, bus::Bus& bus);
  PlannerNode(const PlannerNode&) = delete;
  PlannerNode& operator=(const PlannerNode&) = delete;

  /// Call at least every 10 ms. Announces itself before the first state; a live planner commands
  /// hold, then land, when states stop coming (safety.states_hold_s, safety.states_land_s). In
  /// lockstep it says its last status again and again, so that the next flight knows of it.
  void onWallClock(WallTime now);

 private:
  void subscribe();
  void subscribeOthersCommands();
  void subscribeMap();
  void subscribeScans();
  void subscribeTracks();
  void onStates(const roundabout_msgs::vehicle_states_t& message);
  void publish(const PlannerCore::Tick& tick, double compute_time_s);
  void publishStatus(const Status& status, double compute_time_s);
  void breakSilence(WallTime now, bool due);
  void reject(std::string_view channel, const char* reason);
  void logRejection(std::string_view channel, const char* reason);
  void logModeChange(const Status& status);

  PlannerCore core_;
  config::Planner settings_;
  config::Safety safety_;
  bool live_;
  bus::Bus& bus_;
  core::StatesFrame frame_;
  WallTime last_frame_;
  WallTime last_sent_;
  roundabout_msgs::planner_status_t last_status_{};
  std::set<std::pair<std::string, std::string>> rejections_logged_;  // channel and reason
  Mode logged_mode_ = Mode::kWaiting;
  std::string logged_reason_;
};

}  // namespace roundabout::planner
