#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "common/config/experiment.h"
#include "common/core/agent.h"
#include "common/core/random.h"

namespace roundabout::sim {

/// A polygon of the floor, raised. World frame.
struct Prism {
  core::Polygon outline;
  double bottom_m;
  double top_m;
};

/// Upright. World frame.
struct Cylinder {
  Eigen::Vector2d centre_m;
  double radius_m;
  double bottom_m;
  double top_m;
};

/// What depth cameras see beside the floor.
struct DepthScene {
  std::span<const Prism> prisms{};
  std::span<const Cylinder> cylinders{};  ///< their sides
  Eigen::AlignedBox2d walls;              ///< the edges of the room, as high as anybody looks
};

/// A camera that measures depth: the pinhole of CameraModel, without distortion, its optical axis
/// level.
class DepthCamera {
 public:
  /// Precondition: settings.depth.
  explicit DepthCamera(const config::Camera& settings);

  /// Along the optical axis, mm, row by row from the top; 0: nothing was measured. Valid until the
  /// next call. place, heading: of the vehicle, world. With a `noise` depths get a normal error
  /// that grows with their square, and a share of them is missed.
  std::span<const std::uint16_t> render(const Eigen::Vector2d& place_m, double heading_rad,
                                        const DepthScene& scene,
                                        core::RandomStream* noise = nullptr);

  const config::Camera& settings() const { return settings_; }

 private:
  /// A range of heights that a column's ray meets at a depth.
  struct Side {
    double depth_m;
    double bottom_m;
    double top_m;
  };
  /// A top or bottom between two depths of a column's ray.
  struct Face {
    double height_m;
    double begin_m;
    double end_m;
  };

  void look(const Eigen::Vector2d& ray, const Eigen::Isometry2d& to_camera,
            const DepthScene& scene);
  void lookAt(const Eigen::Vector2d& ray, const Eigen::Isometry2d& to_camera, const Prism& prism);
  double depthAt(double up) const;
  std::uint16_t measured(double depth_m, core::RandomStream* noise) const;

  config::Camera settings_;
  double focal_px_;
  double wall_m_ = 0.0;       // of the column that is looked at
  std::vector<Side> sides_;   // of that column
  std::vector<Face> faces_;   // of that column
  std::vector<double> cuts_;  // of one prism
  std::vector<std::uint16_t> depth_mm_;
};

}  // namespace roundabout::sim
