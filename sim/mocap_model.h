#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/random.h"
#include "common/core/vehicle_state.h"
#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// A fault that comes at random and lasts for a while. The same number of draws in every frame,
/// whatever happens.
class RandomFault {
 public:
  RandomFault(const config::MocapFault& fault, double interval_s)
      : fault_(fault), interval_s_(interval_s) {}
  /// True if the fault is there in the next frame.
  bool next(core::RandomStream& random);

 private:
  const config::MocapFault fault_;
  const double interval_s_;
  double left_s_ = 0.0;
};

/// What cameras say of one vehicle in one frame.
struct MocapPose {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  bool seen = true;      ///< false: the pose is not known to anybody
  bool flipped = false;  ///< the wrong way round about the body's z axis
};

/// One vehicle's truth as cameras see it: noisy, at times not at all or the wrong way round.
class MocapVehicle {
 public:
  /// Random numbers come from the streams "mocap/<name>" and "mocap/flip/<name>" of the seed.
  MocapVehicle(const config::MocapModel& model, const std::string& name, std::uint64_t seed);

  MocapPose expose(const BodyState& truth);

 private:
  const config::MocapModel model_;
  core::RandomStream random_;
  core::RandomStream flip_random_;
  RandomFault dropout_;
  RandomFault flip_;
};

/// What a bridge makes of one vehicle's poses: velocities by first-order filtered differences, and
/// the conventions of mocap_bridge::BodyTracker for what is not seen: predicted at its velocities
/// for filter.coast_s, then lost, its last prediction kept, until it has been seen for
/// filter.reacquire_s. The first frame's pose is believed at once.
class SimulatedTracker {
 public:
  SimulatedTracker(const config::Experiment& experiment, const std::string& name);

  /// The state after one more frame; nullptr: nothing usable of the vehicle was in it. last_seen is
  /// left to the publisher.
  const core::VehicleState& update(const MocapPose* pose);

 private:
  void measure(const MocapPose& pose);
  void predict();
  bool goesOn(double gap_s, double longest_s) const;

  const double velocity_filter_s_;
  const double coast_s_;
  const double reacquire_s_;
  const double interval_s_;
  core::VehicleState estimate_;  // as of the last measurement
  core::VehicleState state_;     // what is shown
  double since_measured_s_ = 0.0;
  double since_believed_s_ = 0.0;
  double acquiring_for_s_ = 0.0;
  int acquiring_poses_ = 0;
  bool seen_ = false;
};

/// What the frames are of.
enum class MocapOutput : std::uint8_t {
  kStates,  ///< VEHICLE_STATES, as of a bridge behind the cameras: what it refuses is not seen
  kScene    ///< what cameras say themselves, for a bridge to judge; velocities are zero
};

/// All vehicles, and the delay line between the world's clock and the frames: at simulated time s
/// goes out the frame of s - latency. Who are exchanged in a swap is drawn from "mocap/swap".
class MocapModel {
 public:
  /// Latency and frame interval count in whole world steps, to the nearest.
  MocapModel(const config::Experiment& experiment, core::Utime step_us,
             MocapOutput output = MocapOutput::kStates);

  core::Utime frameIntervalUs() const { return interval_us_; }
  core::Utime latencyUs() const { return latency_us_; }

  /// Remembers the truth at `now`. To be called once per world step, the first included.
  void observe(core::Utime now, std::span<const BodyState> truth);

  /// The next frame, exposed at utime: frameIntervalUs() after the one before, and observed at most
  /// latencyUs() ago.
  const core::StatesFrame& expose(core::Utime utime);

 private:
  std::size_t slot(core::Utime utime) const;
  void exchange();
  void show(std::size_t vehicle);

  core::Utime step_us_;
  core::Utime interval_us_;
  core::Utime latency_us_;
  MocapOutput output_;
  std::vector<std::vector<BodyState>> history_;  // ring, one slot per world step
  std::vector<MocapVehicle> vehicles_;
  std::vector<SimulatedTracker> trackers_;
  core::RandomStream swap_random_;
  RandomFault swap_;
  std::optional<std::pair<std::size_t, std::size_t>> exchanged_;
  std::vector<MocapPose> poses_;
  core::StatesFrame frame_;
};

}  // namespace roundabout::sim
