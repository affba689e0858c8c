#include "mocap_bridge/estimation/position_filter.h"

#include <algorithm>
#include <cmath>

namespace roundabout::mocap_bridge {

namespace {

// For how long a jerk lasts; with it the density of white jerk is jerk² × this.
constexpr double kJerkTime_s = 0.05;
constexpr double kHuber = 3.0;

}  // namespace

PositionFilter::PositionFilter(const Noise& noise, const Eigen::Vector3d& position_m,
                               double speed_mps, double acceleration_mps2)
    : noise_(noise) {
  state_.row(0) = position_m.transpose();
  covariance_ =
      Eigen::Vector3d(noise.measurement_m, speed_mps, acceleration_mps2).cwiseAbs2().asDiagonal();
}

void PositionFilter::predict(double seconds) {
  const double t = seconds;
  Eigen::Matrix3d step;
  step << 1.0, t, 0.5 * t * t, 0.0, 1.0, t, 0.0, 0.0, 1.0;
  state_ = step * state_;
  const double density = noise_.jerk_mps3 * noise_.jerk_mps3 * kJerkTime_s;
  const double t2 = t * t;
  Eigen::Matrix3d jerk;
  jerk << t2 * t2 * t / 20.0, t2 * t2 / 8.0, t2 * t / 6.0,  //
      t2 * t2 / 8.0, t2 * t / 3.0, t2 / 2.0,                //
      t2 * t / 6.0, t2 / 2.0, t;
  covariance_ = step * covariance_ * step.transpose() + density * jerk;
}

void PositionFilter::update(const Eigen::Vector3d& position_m) {
  const Eigen::RowVector3d innovation = position_m.transpose() - state_.row(0);
  const double deviation = innovationDeviation();
  const double surprise = innovation.cwiseAbs().maxCoeff() / deviation;
  const double doubt = std::max(1.0, surprise / kHuber);
  const double measurement = noise_.measurement_m * noise_.measurement_m * doubt * doubt;
  const Eigen::Vector3d gain = covariance_.col(0) / (covariance_(0, 0) + measurement);
  state_ += gain * innovation;
  // Joseph's form: stays positive whatever the rounding.
  Eigen::Matrix3d keep = Eigen::Matrix3d::Identity();
  keep.col(0) -= gain;
  covariance_ = keep * covariance_ * keep.transpose() + measurement * gain * gain.transpose();
}

double PositionFilter::innovationDeviation() const {
  return std::sqrt(covariance_(0, 0) + noise_.measurement_m * noise_.measurement_m);
}

}  // namespace roundabout::mocap_bridge
