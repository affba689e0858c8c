#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/core/command.h"
#include "common/core/laser_scan.h"
#include "planner/command_law.h"
#include "planner/map/way_finder.h"
#include "planner/policy.h"
#include "planner/safety/room_guard.h"
#include "planner/scan_buffer.h"
#include "planner/situation.h"
#include "planner/status.h"

namespace roundabout::planner {

/// Flies to a goal: asks the policy, and makes its decision a command.
class Pilot {
 public:
  /// Throws core::StartupError for obstacles that the policy does not avoid, and for a vehicle
  /// without the lidar that it flies by.
  Pilot(const config::Experiment& experiment, std::size_t own_index,
        std::unique_ptr<Policy> policy);

  /// A sweep takes effect at the first tick after its utime.
  void onScan(const core::LaserScan& scan) { scans_.add(scan); }
  bool needsScans() const { return policy_->needsScan(); }
  /// False if the policy needs a scan and there is none from the last 0.3 s.
  bool seesEnough(core::Utime now) { return !needsScans() || !freshScan(now).ranges_m.empty(); }

  /// From the first tick after its utime on, the policy is sent round what the map holds, and
  /// velocities that would hit it are not flown.
  void onMap(core::Utime utime, OccupancyGrid map);
  /// At every tick, before anything else.
  void applyMaps(core::Utime now);

  /// A velocity, or position control near the goal (status.mode then becomes AT_GOAL).
  void fly(core::Utime now, const Situation& situation, const core::Goal& goal,
           const RoomGuard& room, core::Command& command, Status& status);

  /// What the map that counts says of a place: near pieces of what stands there. Until the next
  /// call.
  std::span<const core::Polygon> mappedNear(const Eigen::Vector2d& place_m);
  /// Where the vehicle goes first on its way round what the map holds, as of the last fly().
  const std::optional<Eigen::Vector2d>& nextPlace() const { return next_place_m_; }

  /// Position control on the goal.
  static void holdGoal(const Situation& situation, const core::Goal& goal, const RoomGuard& room,
                       core::Command& command);

  /// Another goal: nothing is remembered of the way to the last one.
  void noteNewGoal() { policy_->reset(); }
  /// The states' time went back.
  void beginAnew();
  std::string_view policyName() const { return policy_->name(); }

 private:
  core::RangeScan freshScan(core::Utime now);
  /// What the policy is told: with the next place on the way as its goal.
  core::EgoAgent headedFor(core::EgoAgent ego);
  bool hitsMap(const core::EgoAgent& ego, const Eigen::Vector2d& velocity_mps) const;
  PlanarCommand offMap(const core::EgoAgent& ego, Decision& decision) const;
  std::optional<PlanarCommand> likeliestOffMap(const core::EgoAgent& ego, Decision& decision) const;

  const config::Planner settings_;
  const double max_range_m_;  // of the lidar; 0: there is none
  std::unique_ptr<Policy> policy_;
  std::vector<core::Polygon> obstacles_;
  std::vector<core::OtherAgent> others_;
  ScanBuffer scans_;
  WayFinder::Settings way_settings_;
  struct WaitingMap {
    core::Utime utime;
    WayFinder way_finder;
  };
  std::vector<WaitingMap> waiting_maps_;  // as they came
  core::Utime map_utime_ = 0;             // of the map that counts
  std::optional<WayFinder> way_finder_;   // nothing: there is no map
  std::optional<Eigen::Vector2d> next_place_m_;
  std::vector<core::Polygon> mapped_;
};

}  // namespace roundabout::planner
