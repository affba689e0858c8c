#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace roundabout::core {

/// Axis times angle to the rotation about it. rad.
inline Eigen::Quaterniond fromRotationVector(const Eigen::Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(0.5 * angle);
  rotation.vec() = angle > 1e-9 ? Eigen::Vector3d(std::sin(0.5 * angle) * (vector_rad / angle))
                                : Eigen::Vector3d(0.5 * vector_rad);
  return rotation;
}

/// The shorter way round. rad.
inline Eigen::Vector3d toRotationVector(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double sine = rotation.vec().norm();
  const double scale = sine > 1e-9 ? 2.0 * std::atan2(sine, sign * rotation.w()) / sine : 2.0;
  return sign * scale * rotation.vec();
}

/// Rx(a) Ry(b) Rz(c): about x, then about the turned y, then about the twice turned z. rad.
inline Eigen::Quaterniond fromIntrinsicXyz(const Eigen::Vector3d& angles_rad) {
  return Eigen::AngleAxisd(angles_rad.x(), Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(angles_rad.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles_rad.z(), Eigen::Vector3d::UnitZ());
}

/// Rz(yaw) Ry(pitch) Rx(roll) of angles in the order roll, pitch, yaw. rad.
inline Eigen::Quaterniond fromRollPitchYaw(const Eigen::Vector3d& angles_rad) {
  return Eigen::AngleAxisd(angles_rad.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles_rad.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles_rad.x(), Eigen::Vector3d::UnitX());
}

}  // namespace roundabout::core
