#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/sensor_data.h"
#include "common/core/tick_timer.h"
#include "sim/dynamics/dynamics.h"
#include "sim/sensors/camera.h"

namespace roundabout::sim {

/// The cameras of an experiment's vehicles.
class Cameras {
 public:
  struct Shot {
    std::size_t vehicle;
    std::string camera;
    core::JpegImage image;
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

  std::size_t most_bytes_;
  double person_height_m_;
  std::vector<core::Polygon> obstacles_;
  Eigen::AlignedBox2d room_;
  std::vector<Mounted> cameras_;
  std::vector<Shot> shots_;
};

}  // namespace roundabout::sim
