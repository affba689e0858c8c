#include "sim/dynamics/unicycle/unicycle.h"

#include <algorithm>
#include <cmath>

#include "common/core/angles.h"

namespace roundabout::sim {

namespace {

// Slower than this a direction of travel means nothing.
constexpr double kStandingMps = 1e-6;
constexpr double kPositionGainPerS = 2.0;
// Nearer than this to its position it only turns to its heading.
constexpr double kArrivedM = 0.005;

}  // namespace

std::unique_ptr<Dynamics> Unicycle::make(const config::Vehicle& vehicle, const config::Sim& sim,
                                         const config::Start& start) {
  return std::make_unique<Unicycle>(vehicle, sim.unicycle, start);
}

Unicycle::Unicycle(const config::Vehicle& vehicle, const config::UnicycleModel& model,
                   const config::Start& start)
    : max_turn_rate_radps_(model.max_turn_rate_radps),
      position_speed_mps_(vehicle.preferred_speed_mps),
      heading_rad_(start.heading_rad) {
  body_.position_world_m << start.position_m, vehicle.height_m;
  turn(heading_rad_, 0.0);
}

void Unicycle::step(const Setpoint& setpoint, const Eigen::Vector2d& push_mps2, double step_s) {
  body_.motors_on = setpoint.guidance != Guidance::kMotorsOff;
  const Eigen::Vector2d wanted = wantedVelocity(setpoint, step_s);
  const double speed = wanted.norm();
  const bool moves = speed > kStandingMps;
  const double course = moves ? std::atan2(wanted.y(), wanted.x()) : setpoint.heading_world_rad;
  if (body_.motors_on) {
    turn(course, step_s);
  }
  // With a limited turn rate it drives along its heading and slows down for what is left to turn.
  const double along = moves ? speed * std::max(0.0, std::cos(course - heading_rad_)) : 0.0;
  const Eigen::Vector2d driven =
      along * Eigen::Vector2d(std::cos(heading_rad_), std::sin(heading_rad_));
  pushed_mps_ = push_mps2.isZero() ? Eigen::Vector2d(Eigen::Vector2d::Zero())
                                   : Eigen::Vector2d(pushed_mps_ + push_mps2 * step_s);
  body_.velocity_world_mps << driven + pushed_mps_, 0.0;
  body_.position_world_m += body_.velocity_world_mps * step_s;
}

Eigen::Vector2d Unicycle::wantedVelocity(const Setpoint& setpoint, double step_s) const {
  if (setpoint.guidance == Guidance::kVelocity) {
    return setpoint.velocity_world_mps;
  }
  if (setpoint.guidance != Guidance::kPosition) {
    return Eigen::Vector2d::Zero();
  }
  const Eigen::Vector2d left =
      setpoint.position_world_m.head<2>() - body_.position_world_m.head<2>();
  const double distance = left.norm();
  const double gain = std::min(kPositionGainPerS, 1.0 / step_s);
  const double speed = std::min(gain * distance, position_speed_mps_);
  return distance > kArrivedM ? Eigen::Vector2d(left * (speed / distance))
                              : Eigen::Vector2d::Zero();
}

void Unicycle::turn(double wanted_heading_rad, double step_s) {
  const double most = max_turn_rate_radps_ * step_s;
  const double left = core::wrapToPi(wanted_heading_rad - heading_rad_);
  heading_rad_ = core::wrapToPi(heading_rad_ + std::clamp(left, -most, most));
  body_.orientation = Eigen::AngleAxisd(heading_rad_, Eigen::Vector3d::UnitZ());
}

}  // namespace roundabout::sim
