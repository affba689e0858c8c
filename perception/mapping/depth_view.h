#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/config/experiment.h"
#include "common/core/sensor_data.h"
#include "perception/scan/scan_points.h"

namespace roundabout::perception {

/// A disc of the floor on which somebody is who does not belong into a map. World frame.
struct KeptOut {
  Eigen::Vector2d centre_m;
  double radius_m;
};

/// One depth picture, where it was taken, and who was about.
struct DepthView {
  core::DepthImage image;
  config::Camera camera;  ///< precondition: camera.depth, and the image is of its size
  PlanarPose vehicle;     ///< at the exposure, world
  std::vector<KeptOut> agents;
};

/// Heights above the floor between which something stands in the way.
struct HeightBand {
  double lowest_m;
  double highest_m;
};

/// What one picture says of the floor's cells: places in them, world.
struct DepthUpdate {
  std::vector<Eigen::Vector2d> hits_m;  ///< something in the band stands here, once a cell
  std::vector<Eigen::Vector2d> free_m;  ///< nothing in the band does
};

/// Pixels as places by the pinhole. A cell is hit if two pixels see something in the band in it
/// that is no agent's; floor, and what is above the band, is nothing. A place is free if the whole
/// band above it is in the picture, a fifth of the rows that cross it there measured something, and
/// all of those see something behind it.
DepthUpdate depthUpdateOf(const DepthView& view, const HeightBand& band, double cell_m);

}  // namespace roundabout::perception
