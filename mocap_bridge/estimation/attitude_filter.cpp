#include "mocap_bridge/estimation/attitude_filter.h"

#include <algorithm>
#include <cmath>

#include "common/core/rotation.h"

namespace roundabout::mocap_bridge {

namespace {

// For how long an angular acceleration lasts.
constexpr double kAccelerationTime_s = 0.02;
constexpr double kHuber = 3.0;

}  // namespace

AttitudeFilter::AttitudeFilter(const Noise& noise, const Eigen::Quaterniond& orientation,
                               double rate_radps)
    : noise_(noise), orientation_(orientation.normalized()) {
  covariance_ = Eigen::Vector2d(noise.measurement_rad, rate_radps).cwiseAbs2().asDiagonal();
}

void AttitudeFilter::predict(double seconds) {
  const double t = seconds;
  orientation_ = (orientation_ * core::fromRotationVector(rate_ * t)).normalized();
  // The coupling of angle and rate would turn with the body; by less than a degree in a frame.
  Eigen::Matrix2d step;
  step << 1.0, t, 0.0, 1.0;
  const double density =
      noise_.angular_acceleration_radps2 * noise_.angular_acceleration_radps2 * kAccelerationTime_s;
  Eigen::Matrix2d acceleration;
  acceleration << t * t * t / 3.0, t * t / 2.0, t * t / 2.0, t;
  covariance_ = step * covariance_ * step.transpose() + density * acceleration;
}

void AttitudeFilter::update(const Eigen::Quaterniond& orientation) {
  const Eigen::Vector3d innovation = core::toRotationVector(orientation_.conjugate() * orientation);
  const double surprise = innovation.cwiseAbs().maxCoeff() / innovationDeviation();
  const double doubt = std::max(1.0, surprise / kHuber);
  const double measurement = noise_.measurement_rad * noise_.measurement_rad * doubt * doubt;
  const Eigen::Vector2d gain = covariance_.col(0) / (covariance_(0, 0) + measurement);
  orientation_ = (orientation_ * core::fromRotationVector(gain[0] * innovation)).normalized();
  rate_ += gain[1] * innovation;
  Eigen::Matrix2d keep = Eigen::Matrix2d::Identity();
  keep.col(0) -= gain;
  covariance_ = keep * covariance_ * keep.transpose() + measurement * gain * gain.transpose();
}

double AttitudeFilter::innovationDeviation() const {
  return std::sqrt(covariance_(0, 0) + noise_.measurement_rad * noise_.measurement_rad);
}

}  // namespace roundabout::mocap_bridge
