#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/random.h"
#include "common/core/sensor_data.h"
#include "common/core/tick_timer.h"
#include "sim/dynamics/dynamics.h"
#include "sim/sensors/camera.h"
#include "sim/sensors/depth_camera.h"

namespace roundabout::sim {

/// The cameras of an experiment's vehicles. Those of depth see clutter and other vehicles too.
class Cameras {
 public:
  struct Shot {
    std::size_t vehicle;
    std::string camera;
    std::variant<core::JpegImage, core::DepthImage> image;
  };

  /// most_bytes: of an image.
  Cameras(const config::Experiment& experiment, std::size_t most_bytes);

  /// The images that are due, each camera's at the first call at or after each multiple of its
  /// period. Valid until the next call.
  std::span<const Shot> shoot(core::Utime now, std::span<const BodyState> bodies,
                              std::span<const Pedestrian> people);

 private:
  struct Mounted {
    std::size_t vehicle;
    CameraModel model;
    core::TickTimer timer;
  };
  struct MountedDepth {
    std::size_t vehicle;
    DepthCamera model;
    core::TickTimer timer;
    core::RandomStream noise;
  };

  core::JpegImage takePicture(CameraModel& model, core::Utime now, const BodyState& own,
                              std::span<const Pedestrian> people) const;
  core::DepthImage takeDepths(MountedDepth& camera, core::Utime now,
                              std::span<const BodyState> bodies,
                              std::span<const Pedestrian> people);

  std::size_t most_bytes_;
  config::Pedestrians people_;
  std::vector<double> radii_m_;  // of vehicles
  std::vector<core::Polygon> obstacles_;
  Eigen::AlignedBox2d room_;
  std::vector<Prism> prisms_;
  std::vector<Mounted> cameras_;
  std::vector<MountedDepth> depth_cameras_;
  std::vector<Cylinder> cylinders_;
  std::vector<Shot> shots_;
};

}  // namespace roundabout::sim
