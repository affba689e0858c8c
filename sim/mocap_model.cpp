#include "sim/mocap_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/rotation.h"

namespace roundabout::sim {

namespace {

// Of a vehicle that is found again, as BodyTracker's.
constexpr int kEnoughPoses = 3;
// Gaps are sums of intervals.
constexpr double kRounding_s = 1e-9;

bool faultless(const MocapPose& pose) { return pose.seen && !pose.flipped; }

}  // namespace

bool RandomFault::next(core::RandomStream& random) {
  const bool begins = random.chance(fault_.probability_per_s * interval_s_);
  const double lasts_s = -fault_.duration_s * std::log(1.0 - random.uniform(0.0, 1.0));
  left_s_ = left_s_ > 0.0 ? left_s_ - interval_s_ : begins ? lasts_s : 0.0;
  return left_s_ > 0.0;
}

MocapVehicle::MocapVehicle(const config::MocapModel& model, const std::string& name,
                           std::uint64_t seed)
    : model_(model),
      random_(seed, "mocap/" + name),
      flip_random_(seed, "mocap/flip/" + name),
      dropout_(model.dropout, 1.0 / model.rate_hz),
      flip_(model.flip, 1.0 / model.rate_hz) {}

MocapPose MocapVehicle::expose(const BodyState& truth) {
  MocapPose pose;
  pose.position_world_m = truth.position_world_m + random_.normal3(model_.position_noise_m);
  pose.orientation =
      (truth.orientation * core::fromRotationVector(random_.normal3(model_.orientation_noise_rad)))
          .normalized();
  pose.seen = !dropout_.next(random_);
  pose.flipped = flip_.next(flip_random_);
  if (pose.flipped) {
    pose.orientation *= core::fromRotationVector({0.0, 0.0, std::numbers::pi});
  }
  return pose;
}

SimulatedTracker::SimulatedTracker(const config::Experiment& experiment, const std::string& name)
    : velocity_filter_s_(experiment.sim.mocap.velocity_filter_s),
      coast_s_(experiment.mocap.filter.coast_s),
      reacquire_s_(experiment.mocap.filter.reacquire_s),
      interval_s_(1.0 / experiment.sim.mocap.rate_hz) {
  state_.name = name;
  estimate_.name = name;
}

// Of cameras so slow that one frame to the next is longer, the last frame will do.
bool SimulatedTracker::goesOn(double gap_s, double longest_s) const {
  return gap_s <= std::max(longest_s, interval_s_) + kRounding_s;
}

const core::VehicleState& SimulatedTracker::update(const MocapPose* pose) {
  since_measured_s_ += interval_s_;
  since_believed_s_ += interval_s_;
  const bool believed = !seen_ || goesOn(since_believed_s_, coast_s_);
  bool tracked = false;
  if (pose != nullptr) {
    const bool continues = acquiring_poses_ > 0 && goesOn(since_measured_s_, reacquire_s_);
    acquiring_for_s_ = continues ? acquiring_for_s_ + since_measured_s_ : 0.0;
    acquiring_poses_ = continues ? acquiring_poses_ + 1 : 1;
    measure(*pose);
    tracked = believed ||
              (acquiring_for_s_ + kRounding_s >= reacquire_s_ && acquiring_poses_ >= kEnoughPoses);
  }
  if (tracked) {
    state_ = estimate_;
    since_believed_s_ = 0.0;
    acquiring_poses_ = 0;
  } else if (seen_ && since_believed_s_ <= coast_s_ + kRounding_s) {
    predict();
  }
  state_.tracked = tracked;
  state_.predicted = !tracked && seen_ && since_believed_s_ <= coast_s_ + kRounding_s;
  return state_;
}

void SimulatedTracker::measure(const MocapPose& pose) {
  if (seen_) {
    const double share = 1.0 - std::exp(-since_measured_s_ / velocity_filter_s_);
    const Eigen::Vector3d velocity =
        (pose.position_world_m - estimate_.position_world_m) / since_measured_s_;
    const Eigen::Vector3d angular_velocity =
        core::toRotationVector(estimate_.orientation.conjugate() * pose.orientation) /
        since_measured_s_;
    estimate_.velocity_world_mps += share * (velocity - estimate_.velocity_world_mps);
    estimate_.angular_velocity_body_radps +=
        share * (angular_velocity - estimate_.angular_velocity_body_radps);
  }
  estimate_.position_world_m = pose.position_world_m;
  estimate_.orientation = pose.orientation;
  seen_ = true;
  since_measured_s_ = 0.0;
}

void SimulatedTracker::predict() {
  state_.position_world_m =
      estimate_.position_world_m + since_believed_s_ * estimate_.velocity_world_mps;
  state_.orientation =
      estimate_.orientation *
      core::fromRotationVector(since_believed_s_ * estimate_.angular_velocity_body_radps);
}

MocapModel::MocapModel(const config::Experiment& experiment, core::Utime step_us,
                       MocapOutput output)
    : step_us_(step_us),
      output_(output),
      swap_random_(experiment.seed, "mocap/swap"),
      swap_(experiment.sim.mocap.swap, 1.0 / experiment.sim.mocap.rate_hz) {
  const config::MocapModel& model = experiment.sim.mocap;
  // Counted in steps, since neither may be a whole number of microseconds.
  interval_us_ = step_us * std::llround(1.0 / (model.rate_hz * experiment.sim.step_s));
  const auto latency_steps = static_cast<core::Utime>(
      std::llround(core::toUtime(model.latency_s) / static_cast<double>(step_us)));
  latency_us_ = latency_steps * step_us;
  history_.assign(static_cast<std::size_t>(latency_steps + 1),
                  std::vector<BodyState>(experiment.vehicles.size()));
  vehicles_.reserve(experiment.vehicles.size());
  trackers_.reserve(experiment.vehicles.size());
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    vehicles_.emplace_back(model, vehicle.name, experiment.seed);
    trackers_.emplace_back(experiment, vehicle.name);
    frame_.vehicles.emplace_back().name = vehicle.name;
  }
  poses_.resize(vehicles_.size());
  frame_.frame_number = -1;
}

std::size_t MocapModel::slot(core::Utime utime) const {
  return static_cast<std::size_t>(utime / step_us_) % history_.size();
}

void MocapModel::observe(core::Utime now, std::span<const BodyState> truth) {
  std::copy(truth.begin(), truth.end(), history_[slot(now)].begin());
}

const core::StatesFrame& MocapModel::expose(core::Utime utime) {
  frame_.utime = utime;
  ++frame_.frame_number;
  const std::vector<BodyState>& truth = history_[slot(utime)];
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    poses_[i] = vehicles_[i].expose(truth[i]);
  }
  exchange();
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    show(i);
  }
  return frame_;
}

void MocapModel::exchange() {
  if (vehicles_.size() < 2) {
    return;
  }
  const std::size_t first = swap_random_.index(vehicles_.size());
  const std::size_t other = swap_random_.index(vehicles_.size() - 1);
  if (!swap_.next(swap_random_)) {
    exchanged_.reset();
    return;
  }
  if (!exchanged_) {
    exchanged_ = {first, other < first ? other : other + 1};
  }
  std::swap(poses_[exchanged_->first], poses_[exchanged_->second]);
}

void MocapModel::show(std::size_t vehicle) {
  const MocapPose& pose = poses_[vehicle];
  core::VehicleState& out = frame_.vehicles[vehicle];
  if (output_ == MocapOutput::kScene) {
    out.position_world_m = pose.position_world_m;
    out.orientation = pose.orientation;
    out.tracked = pose.seen;
    return;
  }
  const bool another =
      exchanged_ && (vehicle == exchanged_->first || vehicle == exchanged_->second);
  out = trackers_[vehicle].update(faultless(pose) && !another ? &pose : nullptr);
}

}  // namespace roundabout::sim
