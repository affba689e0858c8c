#include "sim/dynamics/ground_robot/ground_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/angles.h"

namespace roundabout::sim {

namespace {

// Slower than this a direction of travel means nothing.
constexpr double kStandingMps = 1e-3;
// Nearer than this to its position it only turns to its heading.
constexpr double kArrivedM = 0.005;
// On so short a way it reverses rather than turns round.
constexpr double kReverseM = 0.3;
// Of tyres that slip sideways.
constexpr double kFrictionMps2 = 4.0;

}  // namespace

std::unique_ptr<Dynamics> GroundRobot::make(const config::Vehicle& vehicle, const config::Sim& sim,
                                            const config::Start& start) {
  return std::make_unique<GroundRobot>(vehicle, sim.ground_robot, start);
}

GroundRobot::GroundRobot(const config::Vehicle& vehicle, const config::GroundRobotModel& model,
                         const config::Start& start)
    : model_(model),
      max_speed_mps_(std::min(vehicle.top_speed_mps, model.max_wheel_speed_mps)),
      max_acceleration_mps2_(
          std::min(vehicle.max_acceleration_mps2, model.max_wheel_acceleration_mps2)),
      heading_rad_(start.heading_rad) {
  body_.position_world_m << start.position_m, vehicle.height_m;
  body_.orientation = Eigen::AngleAxisd(heading_rad_, Eigen::Vector3d::UnitZ());
}

void GroundRobot::step(const Setpoint& setpoint, const Eigen::Vector2d& push_mps2, double step_s) {
  body_.motors_on = setpoint.guidance != Guidance::kMotorsOff;
  driveWheels(wanted(setpoint), step_s);
  move(push_mps2, step_s);
}

GroundRobot::Twist GroundRobot::wanted(const Setpoint& setpoint) const {
  switch (setpoint.guidance) {
    case Guidance::kVelocity: {
      const double speed_mps = setpoint.velocity_world_mps.norm();
      return speed_mps < kStandingMps ? turned(setpoint.heading_world_rad)
                                      : towards(std::atan2(setpoint.velocity_world_mps.y(),
                                                           setpoint.velocity_world_mps.x()),
                                                speed_mps);
    }
    case Guidance::kPosition:
      return toPosition(setpoint);
    case Guidance::kMotorsOff:
    case Guidance::kBrake:
    case Guidance::kDescend:
      return {};
  }
  return {};
}

GroundRobot::Twist GroundRobot::turned(double heading_rad) const {
  const double left_rad = core::wrapToPi(heading_rad - heading_rad_);
  return {0.0, std::clamp(model_.heading_gain_per_s * left_rad, -model_.max_turn_rate_radps,
                          model_.max_turn_rate_radps)};
}

GroundRobot::Twist GroundRobot::towards(double course_rad, double speed_mps) const {
  Twist twist = turned(course_rad);
  twist.speed_mps = std::min(speed_mps, max_speed_mps_) *
                    std::max(0.0, std::cos(core::wrapToPi(course_rad - heading_rad_)));
  return twist;
}

GroundRobot::Twist GroundRobot::toPosition(const Setpoint& setpoint) const {
  const Eigen::Vector2d left_m =
      setpoint.position_world_m.head<2>() - body_.position_world_m.head<2>();
  const double distance_m = left_m.norm();
  if (distance_m < kArrivedM) {
    return turned(setpoint.heading_world_rad);
  }
  const double speed_mps =
      std::min(model_.position_gain_per_s * distance_m, model_.max_position_speed_mps);
  const double course_rad = std::atan2(left_m.y(), left_m.x());
  const bool behind = std::abs(core::wrapToPi(course_rad - heading_rad_)) > std::numbers::pi / 2.0;
  if (distance_m < kReverseM && behind) {
    Twist twist = towards(course_rad + std::numbers::pi, speed_mps);
    twist.speed_mps = -twist.speed_mps;
    return twist;
  }
  return towards(course_rad, speed_mps);
}

void GroundRobot::driveWheels(const Twist& twist, double step_s) {
  const double share = 1.0 - std::exp(-step_s / model_.wheel_time_constant_s);
  const double half_turn_mps = 0.5 * model_.wheel_base_m * twist.turn_rate_radps;
  // The turn comes first; what the wheels can then still do is left for the way ahead.
  const double most_mps = std::max(0.0, model_.max_wheel_speed_mps - std::abs(half_turn_mps));
  const double speed_mps = std::clamp(twist.speed_mps, -most_mps, most_mps);
  const auto drive = [&](double wanted_mps, double& wheel_mps) {
    const double change = share * (wanted_mps - wheel_mps);
    wheel_mps +=
        std::clamp(change, -max_acceleration_mps2_ * step_s, max_acceleration_mps2_ * step_s);
  };
  drive(speed_mps - half_turn_mps, left_mps_);
  drive(speed_mps + half_turn_mps, right_mps_);
}

void GroundRobot::move(const Eigen::Vector2d& push_mps2, double step_s) {
  const double speed_mps = 0.5 * (left_mps_ + right_mps_);
  const double turn_rad = (right_mps_ - left_mps_) / model_.wheel_base_m * step_s;
  const double middle_rad = heading_rad_ + 0.5 * turn_rad;
  heading_rad_ = core::wrapToPi(heading_rad_ + turn_rad);
  body_.orientation = Eigen::AngleAxisd(heading_rad_, Eigen::Vector3d::UnitZ());
  if (push_mps2.isZero()) {
    const double slides_mps = pushed_mps_.norm();
    const double lost_mps = kFrictionMps2 * step_s;
    pushed_mps_ *= slides_mps > lost_mps ? 1.0 - lost_mps / slides_mps : 0.0;
  } else {
    pushed_mps_ += push_mps2 * step_s;
  }
  body_.velocity_world_mps << speed_mps *
                                      Eigen::Vector2d(std::cos(middle_rad), std::sin(middle_rad)) +
                                  pushed_mps_,
      0.0;
  body_.position_world_m += body_.velocity_world_mps * step_s;
}

}  // namespace roundabout::sim
