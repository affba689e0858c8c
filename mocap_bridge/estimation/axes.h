#pragma once

#include <string>

#include <Eigen/Geometry>

namespace roundabout::mocap_bridge {

/// From a motion-capture system's axes to the world's (x and y span the floor, z is up). Bodies'
/// own axes are turned with them: a body that is aligned with the system's axes is aligned with the
/// world's.
class AxisMap {
 public:
  /// "z_up": as they are. "y_up": (x, -z, y), Motive's. Or which of the system's axes, with its
  /// sign, each of the world's is: "x,-z,y", "z,x,y". Throws core::StartupError: not such a text,
  /// or a mirror image.
  explicit AxisMap(const std::string& axes);

  Eigen::Vector3d toWorld(const Eigen::Vector3d& position) const { return rotation_ * position; }
  Eigen::Quaterniond toWorld(const Eigen::Quaterniond& orientation) const {
    Eigen::Quaterniond turned;
    turned.w() = orientation.w();
    turned.vec() = rotation_ * orientation.vec();
    return turned;
  }
  AxisMap inverse() const;

 private:
  AxisMap() = default;
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
};

}  // namespace roundabout::mocap_bridge
