#pragma once

#include <Eigen/Core>

namespace roundabout::perception {

/// Kalman filter of one body in the plane that moves at constant velocity but for white
/// acceleration. State: position m, velocity m/s, world.
class PersonFilter {
 public:
  using State = Eigen::Vector4d;
  using Covariance = Eigen::Matrix4d;

  /// At rest somewhere, with the velocity unknown to walking speed.
  PersonFilter(const Eigen::Vector2d& position_m, const Eigen::Matrix2d& covariance_m2);

  /// acceleration_density: of the white noise, m^2/s^3.
  void predict(double step_s, double acceleration_density);
  void correct(const Eigen::Vector2d& position_m, const Eigen::Matrix2d& covariance_m2);
  /// Keeps so much of the velocity: who is not seen may have stopped.
  void slowDown(double share) { state_.tail<2>() *= share; }
  /// Squared Mahalanobis distance of a measurement from where it is expected.
  double squaredDistance(const Eigen::Vector2d& position_m,
                         const Eigen::Matrix2d& covariance_m2) const;

  Eigen::Vector2d position() const { return state_.head<2>(); }
  Eigen::Vector2d velocity() const { return state_.tail<2>(); }
  /// Root mean square over the axes.
  double positionDeviation() const;
  double velocityDeviation() const;
  const Covariance& covariance() const { return covariance_; }

 private:
  State state_;
  Covariance covariance_;
};

}  // namespace roundabout::perception
