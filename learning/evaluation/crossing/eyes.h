#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/config/experiment.h"
#include "common/core/agent_tracks.h"
#include "common/core/laser_scan.h"
#include "common/core/sensor_data.h"
#include "common/core/vehicle_state.h"
#include "sim/pedestrians/pedestrian.h"

namespace roundabout::learning {

/// What stands between a robot's sensors and its planner.
class Eyes {
 public:
  Eyes() = default;
  Eyes(const Eyes&) = delete;
  Eyes& operator=(const Eyes&) = delete;
  virtual ~Eyes() = default;

  virtual void onFrame(const core::StatesFrame& frame) = 0;
  /// people: the truth, for eyes that cheat.
  virtual void onScan(const core::LaserScan& scan, std::span<const sim::Pedestrian> people) = 0;
  virtual std::optional<core::AgentTracks> takeTracks() = 0;
  /// What stands still, now and then.
  virtual std::optional<core::OccupancyMap> takeMap() { return std::nullopt; }
};

/// The perception process's own core: tracks and map from the sweeps of the lidar, without images.
std::unique_ptr<Eyes> perceptionEyes(const config::Experiment& experiment,
                                     const std::string& vehicle);

/// Everybody within the lidar's range, exactly, hidden or not: what perfect perception would be
/// worth.
std::unique_ptr<Eyes> trueEyes(const config::Experiment& experiment, const std::string& vehicle);

}  // namespace roundabout::learning
