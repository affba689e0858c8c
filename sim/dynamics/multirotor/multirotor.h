#pragma once

#include <memory>

#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// A multirotor with on-board velocity and position controllers. Equations, parameters and measured
/// step responses: docs/multirotor.md. Starts on the floor with the motors off.
class Multirotor final : public Dynamics {
 public:
  static std::unique_ptr<Dynamics> make(const config::Vehicle& vehicle, const config::Sim& sim,
                                        const config::Start& start);
  Multirotor(const config::MultirotorModel& model, const config::Start& start);

  void step(const Setpoint& setpoint, const Eigen::Vector2d& push_mps2, double step_s) override;
  const BodyState& body() const override { return body_; }
  double commandDelayS() const override { return model_.command_delay_s; }

  /// Angle between the thrust and the vertical. rad.
  double tiltRad() const { return tilt_rad_.norm(); }
  /// What the controllers want of thrust and gravity together, after the limits on acceleration and
  /// jerk.
  const Eigen::Vector3d& wantedAccelerationMps2() const { return wanted_acceleration_; }

 private:
  Eigen::Vector3d wantedVelocity(const Setpoint& setpoint) const;
  void controlAcceleration(const Eigen::Vector3d& wanted_velocity, double step_s);
  void controlYaw(const Setpoint& setpoint, double step_s);
  Eigen::Vector3d thrustAcceleration(double step_s);
  void integrate(const Eigen::Vector3d& acceleration, double step_s);
  void touchFloor(double step_s);

  const config::MultirotorModel model_;
  Eigen::Vector3d wanted_acceleration_ = Eigen::Vector3d::Zero();
  /// Direction: where the thrust leans, world; length: by how much.
  Eigen::Vector2d tilt_rad_ = Eigen::Vector2d::Zero();
  double heading_rad_;
  double yaw_rate_radps_ = 0.0;
  BodyState body_;
};

}  // namespace roundabout::sim
