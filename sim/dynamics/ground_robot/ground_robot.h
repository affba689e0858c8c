#pragma once

#include <memory>

#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// Two driven wheels on one axle and a castor (unicycle kinematics; Siegwart et al., Introduction
/// to Autonomous Mobile Robots, section 3.2), behind speed controllers with a lag and a limited
/// acceleration. A velocity command is a course and a speed: it turns to the course as fast as it
/// may, and drives along its heading with the share of the speed that points there, backwards
/// never. On the last part of the way to a position it may reverse. It lives in the plane of its
/// vehicle's height_m, sets off by starting to move and lands by stopping.
class GroundRobot final : public Dynamics {
 public:
  static std::unique_ptr<Dynamics> make(const config::Vehicle& vehicle, const config::Sim& sim,
                                        const config::Start& start);
  GroundRobot(const config::Vehicle& vehicle, const config::GroundRobotModel& model,
              const config::Start& start);

  /// A push moves it over the floor, on wheels that slip; friction ends that.
  void step(const Setpoint& setpoint, const Eigen::Vector2d& push_mps2, double step_s) override;
  const BodyState& body() const override { return body_; }
  double commandDelayS() const override { return model_.command_delay_s; }
  WheelSpeeds wheels() const override { return {left_mps_, right_mps_}; }

 private:
  /// Along and about.
  struct Twist {
    double speed_mps = 0.0;
    double turn_rate_radps = 0.0;
  };

  Twist wanted(const Setpoint& setpoint) const;
  Twist towards(double course_rad, double speed_mps) const;
  Twist toPosition(const Setpoint& setpoint) const;
  Twist turned(double heading_rad) const;
  void driveWheels(const Twist& twist, double step_s);
  void move(const Eigen::Vector2d& push_mps2, double step_s);

  const config::GroundRobotModel model_;
  const double max_speed_mps_;
  const double max_acceleration_mps2_;
  double heading_rad_;
  double left_mps_ = 0.0;  // of the rims
  double right_mps_ = 0.0;
  Eigen::Vector2d pushed_mps_ = Eigen::Vector2d::Zero();
  BodyState body_;
};

}  // namespace roundabout::sim
