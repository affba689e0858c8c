#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "common/config/experiment.h"
#include "common/core/agent_tracks.h"
#include "common/core/tick_timer.h"
#include "sim/sensors/cameras.h"
#include "sim/sensors/laser_scanners.h"
#include "sim/sensors/odometer.h"
#include "sim/world.h"

namespace roundabout::sim {

/// What vehicles carry, as their drivers publish it: LASER_SCAN_<vehicle>, IMAGE_<vehicle>_<camera>
/// and ODOMETRY_<vehicle>; and PEDESTRIAN_TRUTH, which is nobody's sensor.
class SensorNode {
 public:
  SensorNode(const config::Experiment& experiment, const World& world, bus::Bus& bus);

  /// Call after every step of the world.
  void onStep(const World& world);
  /// Measures what is due; publish() sends it.
  void measure(const World& world);
  void publish();

  /// utime of the newest sweep that a vehicle has published; 0: none.
  core::Utime newestScan(std::size_t vehicle) const { return newest_scan_[vehicle]; }

  /// Where vehicles are as whoever localises them knows it. Valid until the next call.
  std::span<const BodyState> believed(const World& world) {
    return odometers_.believed(world.bodies());
  }
  core::Command asDriven(const World& world, std::size_t vehicle,
                         const core::Command& command) const {
    return odometers_.asDriven(vehicle, command, world.bodies());
  }

 private:
  const config::Experiment experiment_;
  const double step_s_;
  LaserScanners scanners_;
  Cameras cameras_;
  Odometers odometers_;
  core::TickTimer truth_timer_;
  std::span<const LaserScanners::Sweep> sweeps_;
  std::span<const Cameras::Shot> shots_;
  std::span<const Odometers::Reading> readings_;
  std::vector<core::Utime> newest_scan_;  // of each vehicle
  core::AgentTracks truth_;
  bool truth_due_ = false;
  bus::Bus& bus_;
};

}  // namespace roundabout::sim
