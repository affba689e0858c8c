#pragma once

#include <Eigen/Geometry>

namespace roundabout::mocap_bridge {

/// Multiplicative Kalman filter of an attitude that turns at a constant rate but for white angular
/// acceleration (Markley, "Attitude Error Representations for Kalman Filtering", 2003): the state
/// is a unit quaternion, body to world, and the angular velocity in body axes; the error is a
/// rotation vector in body axes. Noise is the same about all axes, so they share one covariance of
/// (angle, rate). rad, s.
class AttitudeFilter {
 public:
  struct Noise {
    double measurement_rad = 0.002;             ///< standard deviation per axis
    double angular_acceleration_radps2 = 10.0;  ///< that is reached, for about 20 ms at a time
  };

  AttitudeFilter() = default;
  /// Of the rate only this standard deviation is known.
  AttitudeFilter(const Noise& noise, const Eigen::Quaterniond& orientation, double rate_radps);

  void predict(double seconds);
  void update(const Eigen::Quaterniond& orientation);

  const Eigen::Quaterniond& orientation() const { return orientation_; }
  const Eigen::Vector3d& angularVelocityBody() const { return rate_; }
  double innovationDeviation() const;

 private:
  Noise noise_;
  Eigen::Quaterniond orientation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate_ = Eigen::Vector3d::Zero();
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Identity();
};

}  // namespace roundabout::mocap_bridge
