#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/random.h"
#include "common/core/vehicle_state.h"
#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// What a motion-capture system and its bridge make of one vehicle's truth: noisy pose, velocities
/// by first-order filtered differences of the noisy poses, and times in which the cameras do not
/// see it. While hidden a vehicle keeps its last estimate.
class MocapVehicle {
 public:
  /// Random numbers come from the stream "mocap/<name>" of the seed, as many in every frame
  /// whatever happens.
  MocapVehicle(const config::MocapModel& model, const std::string& name, std::uint64_t seed);

  /// The estimate after one more camera frame. last_seen is left to the publisher.
  const core::VehicleState& expose(const BodyState& truth);

 private:
  bool hidden();
  void estimate(const Eigen::Vector3d& position_world_m, const Eigen::Quaterniond& orientation);

  const config::MocapModel model_;
  const double interval_s_;
  core::RandomStream random_;
  core::VehicleState state_;
  double hidden_for_s_ = 0.0;
  double since_seen_s_ = 0.0;
  bool seen_ = false;
};

/// All vehicles, and the delay line between the world's clock and the frames: at simulated time s
/// goes out the frame of s - latency.
class MocapModel {
 public:
  /// Latency and frame interval count in whole world steps, to the nearest.
  MocapModel(const config::Experiment& experiment, core::Utime step_us);

  core::Utime frameIntervalUs() const { return interval_us_; }
  core::Utime latencyUs() const { return latency_us_; }

  /// Remembers the truth at `now`. To be called once per world step, the first included.
  void observe(core::Utime now, std::span<const BodyState> truth);

  /// The next frame, exposed at utime: frameIntervalUs() after the one before, and observed at most
  /// latencyUs() ago.
  const core::StatesFrame& expose(core::Utime utime);

 private:
  std::size_t slot(core::Utime utime) const;

  core::Utime step_us_;
  core::Utime interval_us_;
  core::Utime latency_us_;
  std::vector<std::vector<BodyState>> history_;  // ring, one slot per world step
  std::vector<MocapVehicle> vehicles_;
  core::StatesFrame frame_;
};

}  // namespace roundabout::sim
