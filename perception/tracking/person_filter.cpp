#include "perception/tracking/person_filter.h"

#include <cmath>

#include <Eigen/LU>

namespace roundabout::perception {

namespace {

constexpr double kWalking_mps = 1.0;

}  // namespace

PersonFilter::PersonFilter(const Eigen::Vector2d& position_m,
                           const Eigen::Matrix2d& covariance_m2) {
  state_ << position_m, 0.0, 0.0;
  covariance_.setZero();
  covariance_.topLeftCorner<2, 2>() = covariance_m2;
  covariance_.bottomRightCorner<2, 2>() = kWalking_mps * kWalking_mps * Eigen::Matrix2d::Identity();
}

void PersonFilter::predict(double step_s, double acceleration_density) {
  const double t = step_s;
  Eigen::Matrix4d transition = Eigen::Matrix4d::Identity();
  transition.topRightCorner<2, 2>() = t * Eigen::Matrix2d::Identity();
  Eigen::Matrix4d noise;
  noise << t * t * t / 3.0 * Eigen::Matrix2d::Identity(), t * t / 2.0 * Eigen::Matrix2d::Identity(),
      t * t / 2.0 * Eigen::Matrix2d::Identity(), t * Eigen::Matrix2d::Identity();
  state_ = transition * state_;
  covariance_ = transition * covariance_ * transition.transpose() + acceleration_density * noise;
}

void PersonFilter::correct(const Eigen::Vector2d& position_m,
                           const Eigen::Matrix2d& covariance_m2) {
  const Eigen::Matrix2d expected = covariance_.topLeftCorner<2, 2>() + covariance_m2;
  const Eigen::Matrix<double, 4, 2> gain = covariance_.leftCols<2>() * expected.inverse();
  state_ += gain * (position_m - position());
  // Joseph's form stays symmetric and positive.
  Eigen::Matrix4d left = Eigen::Matrix4d::Identity();
  left.leftCols<2>() -= gain;
  covariance_ = left * covariance_ * left.transpose() + gain * covariance_m2 * gain.transpose();
}

double PersonFilter::squaredDistance(const Eigen::Vector2d& position_m,
                                     const Eigen::Matrix2d& covariance_m2) const {
  const Eigen::Matrix2d expected = covariance_.topLeftCorner<2, 2>() + covariance_m2;
  const Eigen::Vector2d error_m = position_m - position();
  return error_m.dot(expected.inverse() * error_m);
}

double PersonFilter::positionDeviation() const {
  return std::sqrt(covariance_.topLeftCorner<2, 2>().trace() / 2.0);
}

double PersonFilter::velocityDeviation() const {
  return std::sqrt(covariance_.bottomRightCorner<2, 2>().trace() / 2.0);
}

}  // namespace roundabout::perception
