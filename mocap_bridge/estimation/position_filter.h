#pragma once

#include <Eigen/Core>

namespace roundabout::mocap_bridge {

/// Kalman filter of a point that moves with constant acceleration but for white jerk (Bar-Shalom,
/// "Estimation with Applications to Tracking and Navigation", 6.2.3). The three axes are
/// independent and equally noisy, so they share one covariance of (position, velocity,
/// acceleration). World frame, SI units. Innovations beyond three standard deviations weigh less,
/// as by Huber.
class PositionFilter {
 public:
  struct Noise {
    double measurement_m = 0.0002;  ///< standard deviation per axis
    double jerk_mps3 = 30.0;        ///< that is reached, for about 50 ms at a time
  };

  PositionFilter() = default;
  /// At rest somewhere there, as far as one measurement tells: of speed and acceleration, only
  /// these standard deviations are known.
  PositionFilter(const Noise& noise, const Eigen::Vector3d& position_m, double speed_mps,
                 double acceleration_mps2);

  void predict(double seconds);
  void update(const Eigen::Vector3d& position_m);

  const Eigen::Vector3d position() const { return state_.row(0).transpose(); }
  const Eigen::Vector3d velocity() const { return state_.row(1).transpose(); }
  /// Standard deviation of a measurement's distance from position(), per axis.
  double innovationDeviation() const;

 private:
  Noise noise_;
  Eigen::Matrix3d state_ = Eigen::Matrix3d::Zero();  // rows p, v, a; columns x, y, z
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Identity();
};

}  // namespace roundabout::mocap_bridge
