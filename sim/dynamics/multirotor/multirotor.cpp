#include "sim/dynamics/multirotor/multirotor.h"

#include <algorithm>
#include <cmath>

#include "common/core/angles.h"

namespace roundabout::sim {

namespace {

constexpr double kFloorFriction = 0.6;
// On the floor the legs level it.
constexpr double kLevellingTimeS = 0.05;
// Rotors do not pull down, and need some thrust to keep the attitude.
constexpr double kLeastThrustMps2 = 0.1 * kGravityMps2;

template <class Vector>
Vector limited(const Vector& vector, double longest) {
  const double length = vector.norm();
  return length > longest ? Vector(vector * (longest / length)) : vector;
}

// The share of the way to its input that a first-order lag goes within a step.
double lagShare(double step_s, double time_constant_s) {
  return 1.0 - std::exp(-step_s / time_constant_s);
}

}  // namespace

std::unique_ptr<Dynamics> Multirotor::make(const config::Vehicle& /*vehicle*/,
                                           const config::Sim& sim, const config::Start& start) {
  return std::make_unique<Multirotor>(sim.multirotor, start);
}

Multirotor::Multirotor(const config::MultirotorModel& model, const config::Start& start)
    : model_(model), heading_rad_(start.heading_rad) {
  body_.position_world_m << start.position_m, 0.0;
  body_.orientation = Eigen::AngleAxisd(heading_rad_, Eigen::Vector3d::UnitZ());
}

void Multirotor::step(const Setpoint& setpoint, const Eigen::Vector2d& push_mps2, double step_s) {
  body_.motors_on = setpoint.guidance != Guidance::kMotorsOff;
  Eigen::Vector3d acceleration(push_mps2.x(), push_mps2.y(), -kGravityMps2);
  acceleration -= model_.drag_per_s * body_.velocity_world_mps;
  if (body_.motors_on) {
    controlAcceleration(wantedVelocity(setpoint), step_s);
    controlYaw(setpoint, step_s);
    acceleration += thrustAcceleration(step_s);
  } else {
    wanted_acceleration_.setZero();
    yaw_rate_radps_ = 0.0;
  }
  integrate(acceleration, step_s);
  touchFloor(step_s);

  const double tilt = tilt_rad_.norm();
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(heading_rad_, Eigen::Vector3d::UnitZ()));
  if (tilt > 0.0) {
    const Eigen::Vector3d axis(-tilt_rad_.y() / tilt, tilt_rad_.x() / tilt, 0.0);
    body_.orientation = Eigen::AngleAxisd(tilt, axis) * yaw;
  } else {
    body_.orientation = yaw;
  }
}

Eigen::Vector3d Multirotor::wantedVelocity(const Setpoint& setpoint) const {
  if (setpoint.guidance == Guidance::kBrake) {
    return Eigen::Vector3d::Zero();
  }
  const Eigen::Vector3d to_position =
      model_.position_gain_per_s * (setpoint.position_world_m - body_.position_world_m);
  Eigen::Vector3d velocity;
  velocity.head<2>() =
      setpoint.guidance == Guidance::kVelocity
          ? setpoint.velocity_world_mps
          : limited(Eigen::Vector2d(to_position.head<2>()), model_.max_position_speed_mps);
  velocity.z() = setpoint.guidance == Guidance::kDescend
                     ? -model_.max_descend_mps
                     : std::clamp(to_position.z(), -model_.max_descend_mps, model_.max_climb_mps);
  return velocity;
}

// Velocity error to acceleration, with the drag of the wanted velocity fed forward.
void Multirotor::controlAcceleration(const Eigen::Vector3d& wanted_velocity, double step_s) {
  Eigen::Vector3d wanted =
      model_.velocity_gain_per_s * (wanted_velocity - body_.velocity_world_mps) +
      model_.drag_per_s * wanted_velocity;
  wanted.head<2>() = limited(Eigen::Vector2d(wanted.head<2>()), model_.max_acceleration_mps2);
  wanted.z() = std::clamp(wanted.z(), -model_.max_acceleration_mps2, model_.max_acceleration_mps2);
  wanted_acceleration_ +=
      limited(Eigen::Vector3d(wanted - wanted_acceleration_), model_.max_jerk_mps3 * step_s);
}

void Multirotor::controlYaw(const Setpoint& setpoint, double step_s) {
  const double error = core::wrapToPi(setpoint.heading_world_rad - heading_rad_);
  const double wanted_rate = std::clamp(model_.yaw_gain_per_s * error + setpoint.heading_rate_radps,
                                        -model_.max_yaw_rate_radps, model_.max_yaw_rate_radps);
  yaw_rate_radps_ +=
      lagShare(step_s, model_.attitude_time_constant_s) * (wanted_rate - yaw_rate_radps_);
  heading_rad_ = core::wrapToPi(heading_rad_ + yaw_rate_radps_ * step_s);
}

// The thrust's vertical part is what was asked for; its horizontal part follows from the tilt that
// the lagging attitude has reached.
Eigen::Vector3d Multirotor::thrustAcceleration(double step_s) {
  const double vertical = std::max(kGravityMps2 + wanted_acceleration_.z(), kLeastThrustMps2);
  const Eigen::Vector2d horizontal = wanted_acceleration_.head<2>();
  const double wanted_horizontal = horizontal.norm();
  Eigen::Vector2d wanted_tilt = Eigen::Vector2d::Zero();
  if (wanted_horizontal > 0.0) {
    const double angle = std::min(std::atan2(wanted_horizontal, vertical), model_.max_tilt_rad);
    wanted_tilt = horizontal * (angle / wanted_horizontal);
  }
  tilt_rad_ += lagShare(step_s, model_.attitude_time_constant_s) * (wanted_tilt - tilt_rad_);

  const double tilt = tilt_rad_.norm();
  Eigen::Vector3d thrust(0.0, 0.0, vertical);
  if (tilt > 0.0) {
    thrust.head<2>() = tilt_rad_ * (vertical * std::tan(tilt) / tilt);
  }
  return thrust;
}

void Multirotor::integrate(const Eigen::Vector3d& acceleration, double step_s) {
  body_.position_world_m +=
      body_.velocity_world_mps * step_s + acceleration * (0.5 * step_s * step_s);
  body_.velocity_world_mps += acceleration * step_s;
}

void Multirotor::touchFloor(double step_s) {
  body_.on_floor = body_.position_world_m.z() <= 0.0;
  if (!body_.on_floor) {
    return;
  }
  body_.position_world_m.z() = 0.0;
  body_.velocity_world_mps.z() = std::max(body_.velocity_world_mps.z(), 0.0);
  const double speed = body_.velocity_world_mps.head<2>().norm();
  const double braking = kFloorFriction * kGravityMps2 * step_s;
  body_.velocity_world_mps.head<2>() *= speed > braking ? 1.0 - braking / speed : 0.0;
  if (!body_.motors_on) {
    tilt_rad_ *= 1.0 - lagShare(step_s, kLevellingTimeS);
  }
}

}  // namespace roundabout::sim
