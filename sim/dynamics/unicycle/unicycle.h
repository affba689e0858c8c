#pragma once

#include <memory>

#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// The vehicle that the policies were trained on (paper, section "Problem Formulation": unicycle
/// kinematics): speed and heading are what was commanded, at once, save for an optional limit on
/// the turn rate. It lives in the plane of its vehicle's height_m, takes off by starting to move
/// and lands by stopping.
class Unicycle final : public Dynamics {
 public:
  static std::unique_ptr<Dynamics> make(const config::Vehicle& vehicle, const config::Sim& sim,
                                        const config::Start& start);
  Unicycle(const config::Vehicle& vehicle, const config::UnicycleModel& model,
           const config::Start& start);

  /// The speed that a push gives is gone when the push ends: it has no inertia.
  void step(const Setpoint& setpoint, const Eigen::Vector2d& push_mps2, double step_s) override;
  const BodyState& body() const override { return body_; }
  double commandDelayS() const override { return 0.0; }

 private:
  Eigen::Vector2d wantedVelocity(const Setpoint& setpoint, double step_s) const;
  void turn(double wanted_heading_rad, double step_s);

  const double max_turn_rate_radps_;
  const double position_speed_mps_;
  double heading_rad_;
  Eigen::Vector2d pushed_mps_ = Eigen::Vector2d::Zero();
  BodyState body_;
};

}  // namespace roundabout::sim
