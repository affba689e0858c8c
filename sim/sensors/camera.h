#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "common/config/experiment.h"
#include "common/core/agent.h"
#include "sim/pedestrians/pedestrian.h"

namespace roundabout::sim {

/// What a camera sees beside people.
struct Stage {
  std::span<const core::Polygon> obstacles{};  ///< as high as the walls
  Eigen::AlignedBox2d walls;                   ///< the edges of the room
};

/// A pinhole camera without distortion, upright: x of the image to the right, y down; the optical
/// axis, in the middle of the image, is level. It draws a floor, walls and people with heads,
/// trunks, arms and legs in their gait: enough for a people detector, not a photograph.
class CameraModel {
 public:
  explicit CameraModel(const config::Camera& settings);

  /// RGB, three bytes a pixel, row by row from the top; valid until the next call. place, heading:
  /// of the vehicle, world.
  std::span<const std::uint8_t> render(const Eigen::Vector2d& place_m, double heading_rad,
                                       const Stage& stage, std::span<const Pedestrian> people,
                                       double person_height_m);

  /// Pixels per unit of tangent: the focal length.
  double focalPx() const { return focal_px_; }
  const config::Camera& settings() const { return settings_; }

 private:
  struct Colour {
    double red;
    double green;
    double blue;
  };

  void drawStage(const Eigen::Vector2d& place_m, double heading_rad, const Stage& stage);
  void drawPerson(const Eigen::Vector2d& seen_m, const Pedestrian& person, double heading_rad,
                  double height_m);
  void set(int column, int row, const Colour& colour, double light);

  const config::Camera settings_;
  const double focal_px_;
  std::vector<double> depth_m_;  // of the wall, by column
  std::vector<std::uint8_t> rgb_;
};

}  // namespace roundabout::sim
