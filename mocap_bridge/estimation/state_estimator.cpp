#include "mocap_bridge/estimation/state_estimator.h"

#include <algorithm>

#include "common/core/error.h"
#include "common/core/rotation.h"

namespace roundabout::mocap_bridge {

namespace {

// Of the smaller body's radius: centres are never so close side by side.
constexpr double kSamePlace = 0.7;
constexpr core::Utime kNewEpoch = core::kMicrosPerSecond / 2;
// Acceleration that a vehicle may have had when it was found again.
constexpr double kFoundAcceleration_mps2 = 10.0;
// Pushed by hands and gusts, it may be faster than its own limit.
constexpr double kSpeedMargin = 1.5;

TrackerSettings settingsOf(const config::MocapFilter& filter, const config::Vehicle& vehicle) {
  TrackerSettings settings;
  settings.position = {filter.position_noise_m, filter.jerk_mps3};
  settings.attitude = {filter.orientation_noise_rad, filter.angular_acceleration_radps2};
  settings.max_speed_mps = kSpeedMargin * vehicle.top_speed_mps;
  settings.max_acceleration_mps2 = kFoundAcceleration_mps2;
  settings.max_turn_rate_radps = filter.max_turn_rate_radps;
  settings.max_residual_m = filter.max_residual_m;
  settings.coast_us = core::toUtime(filter.coast_s);
  settings.reacquire_us = core::toUtime(filter.reacquire_s);
  return settings;
}

}  // namespace

bool StateEstimator::Mapping::is(const BodyPose& pose) const {
  return config::matches(key, pose.name, pose.id);
}

StateEstimator::StateEstimator(const config::Experiment& experiment, const std::string& usual_axes)
    : axes_(experiment.mocap.axes == "auto" ? usual_axes : experiment.mocap.axes),
      scale_(experiment.mocap.scale),
      accept_recorded_(experiment.mocap.accept_recorded) {
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    const config::BodyKey key = config::bodyKeyOf(experiment.mocap, vehicle.name);
    Mapping mapping;
    mapping.key = key;
    if (const auto* body = config::mocapBodyOf(experiment.mocap, vehicle.name)) {
      mapping.offset_m = body->offset_m;
      mapping.rotation = core::fromRollPitchYaw(body->rotation_rad);
    }
    radii_m_.push_back(vehicle.body_radius_m);
    settings_.push_back(settingsOf(experiment.mocap.filter, vehicle));
    vehicles_.push_back(
        {vehicle.name, key, text(key), false, std::nullopt, BodyTracker(settings_.back())});
    mappings_.push_back(std::move(mapping));
    states_.vehicles.emplace_back().name = vehicle.name;
  }
  places_.resize(vehicles_.size());
  bodies_.resize(vehicles_.size());
  poses_.resize(vehicles_.size());
}

const BodyPose* StateEstimator::find(Mapping& mapping, const SourceFrame& frame) const {
  if (mapping.hint < frame.bodies.size() && mapping.is(frame.bodies[mapping.hint])) {
    return &frame.bodies[mapping.hint];
  }
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    if (mapping.is(frame.bodies[i])) {
      mapping.hint = i;
      return &frame.bodies[i];
    }
  }
  return nullptr;
}

MeasuredPose StateEstimator::measured(const Mapping& mapping, const BodyPose& body) const {
  MeasuredPose pose;
  const Eigen::Quaterniond orientation = axes_.toWorld(body.orientation);
  pose.position_m = scale_ * axes_.toWorld(body.position_m) + orientation * mapping.offset_m;
  pose.orientation = orientation * mapping.rotation;
  pose.tracked = body.tracked;
  pose.residual_m = body.residual_m;
  return pose;
}

bool StateEstimator::isOthersPlace(std::size_t vehicle, const Eigen::Vector3d& position_m,
                                   core::Utime utime) const {
  const auto own = vehicles_[vehicle].tracker.placeAt(utime);
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    if (i == vehicle || !places_[i]) {
      continue;
    }
    const double same_m = kSamePlace * std::min(radii_m_[vehicle], radii_m_[i]);
    const double other_m2 = (*places_[i] - position_m).squaredNorm();
    if (other_m2 >= same_m * same_m) {
      continue;
    }
    // Of a vehicle whose place is not known, only another's that is empty: it may stand on one.
    if (own ? other_m2 < (*own - position_m).squaredNorm() : !isSeenAt(i, same_m)) {
      return true;
    }
  }
  return false;
}

// Its own body is where it is believed to be.
bool StateEstimator::isSeenAt(std::size_t vehicle, double within_m) const {
  return poses_[vehicle] && poses_[vehicle]->tracked &&
         (poses_[vehicle]->position_m - *places_[vehicle]).norm() < within_m;
}

// A body by its name for one vehicle and by its id for another: only frames show that it is one.
void StateEstimator::refuseShared() {
  for (Vehicle& vehicle : vehicles_) {
    vehicle.rival.reset();
  }
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (bodies_[i] != nullptr && bodies_[i] == bodies_[j]) {
        vehicles_[i].rival = j;
        vehicles_[j].rival = i;
        poses_[i].reset();
        poses_[j].reset();
      }
    }
  }
}

void StateEstimator::forget() {
  ++counters_.epochs;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    vehicles_[i].tracker = BodyTracker(settings_[i]);
  }
}

bool StateEstimator::update(const SourceFrame& frame) {
  if (frame.recorded && !accept_recorded_) {
    ++counters_.recorded;
    return false;
  }
  const core::Utime utime = frame.exposure_utime;
  if (utime <= states_.exposure_utime) {
    if (states_.exposure_utime - utime < kNewEpoch) {
      ++counters_.old;
      return false;
    }
    forget();
  }
  ++counters_.frames;
  states_.frame_number = frame.number;
  states_.exposure_utime = utime;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    places_[i] = vehicles_[i].tracker.placeAt(utime);
    const BodyPose* body = find(mappings_[i], frame);
    bodies_[i] = body;
    vehicles_[i].streamed = body != nullptr;
    poses_[i] = body == nullptr ? std::nullopt : std::optional(measured(mappings_[i], *body));
  }
  refuseShared();
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    Vehicle& vehicle = vehicles_[i];
    if (const std::optional<MeasuredPose>& pose = poses_[i]) {
      const bool others = isOthersPlace(i, pose->position_m, utime);
      vehicle.last = vehicle.tracker.update(utime, *pose, others);
    } else {
      vehicle.last = vehicle.tracker.miss(utime);
    }
  }
  fill(utime);
  return true;
}

const core::StatesFrame& StateEstimator::statesAt(core::Utime utime) {
  fill(std::max(utime, states_.exposure_utime));
  return states_;
}

void StateEstimator::fill(core::Utime utime) {
  states_.utime = utime;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    vehicles_[i].tracker.stateAt(utime, states_.vehicles[i]);
  }
}

}  // namespace roundabout::mocap_bridge
