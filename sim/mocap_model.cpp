#include "sim/mocap_model.h"

#include <algorithm>
#include <cmath>

namespace roundabout::sim {

namespace {

Eigen::Quaterniond rotation(const Eigen::Vector3d& rotation_vector_rad) {
  const double angle = rotation_vector_rad.norm();
  return angle > 0.0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_vector_rad / angle))
                     : Eigen::Quaterniond::Identity();
}

// The shorter way round.
Eigen::Vector3d rotationVector(Eigen::Quaterniond rotation) {
  if (rotation.w() < 0.0) {
    rotation.coeffs() *= -1.0;
  }
  const double sine = rotation.vec().norm();
  return sine > 0.0
             ? Eigen::Vector3d(rotation.vec() * (2.0 * std::atan2(sine, rotation.w()) / sine))
             : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

}  // namespace

MocapVehicle::MocapVehicle(const config::MocapModel& model, const std::string& name,
                           std::uint64_t seed)
    : model_(model), interval_s_(1.0 / model.rate_hz), random_(seed, "mocap/" + name) {
  state_.name = name;
}

const core::VehicleState& MocapVehicle::expose(const BodyState& truth) {
  const Eigen::Vector3d position =
      truth.position_world_m + random_.normal3(model_.position_noise_m);
  const Eigen::Quaterniond orientation =
      (truth.orientation * rotation(random_.normal3(model_.orientation_noise_rad))).normalized();
  since_seen_s_ += interval_s_;
  state_.tracked = !hidden();
  if (state_.tracked) {
    estimate(position, orientation);
  }
  return state_;
}

bool MocapVehicle::hidden() {
  const bool hides = random_.chance(model_.dropout.probability_per_s * interval_s_);
  const double hides_for_s = -model_.dropout.duration_s * std::log(1.0 - random_.uniform(0.0, 1.0));
  hidden_for_s_ = hidden_for_s_ > 0.0 ? hidden_for_s_ - interval_s_ : hides ? hides_for_s : 0.0;
  return hidden_for_s_ > 0.0;
}

void MocapVehicle::estimate(const Eigen::Vector3d& position_world_m,
                            const Eigen::Quaterniond& orientation) {
  if (seen_) {
    const double share = 1.0 - std::exp(-since_seen_s_ / model_.velocity_filter_s);
    const Eigen::Vector3d velocity = (position_world_m - state_.position_world_m) / since_seen_s_;
    const Eigen::Vector3d angular_velocity =
        rotationVector(state_.orientation.conjugate() * orientation) / since_seen_s_;
    state_.velocity_world_mps += share * (velocity - state_.velocity_world_mps);
    state_.angular_velocity_body_radps +=
        share * (angular_velocity - state_.angular_velocity_body_radps);
  }
  state_.position_world_m = position_world_m;
  state_.orientation = orientation;
  seen_ = true;
  since_seen_s_ = 0.0;
}

MocapModel::MocapModel(const config::Experiment& experiment, core::Utime step_us)
    : step_us_(step_us) {
  const config::MocapModel& model = experiment.sim.mocap;
  // Counted in steps, since neither may be a whole number of microseconds.
  interval_us_ = step_us * std::llround(1.0 / (model.rate_hz * experiment.sim.step_s));
  const auto latency_steps = static_cast<core::Utime>(
      std::llround(core::toUtime(model.latency_s) / static_cast<double>(step_us)));
  latency_us_ = latency_steps * step_us;
  history_.assign(static_cast<std::size_t>(latency_steps + 1),
                  std::vector<BodyState>(experiment.vehicles.size()));
  vehicles_.reserve(experiment.vehicles.size());
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    vehicles_.emplace_back(model, vehicle.name, experiment.seed);
  }
  frame_.vehicles.resize(vehicles_.size());
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
    frame_.vehicles[i] = vehicles_[i].expose(truth[i]);
  }
  return frame_;
}

}  // namespace roundabout::sim
