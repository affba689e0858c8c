#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/core/time.h"

namespace roundabout::core {

/// One compressed picture.
struct JpegImage {
  Utime utime = 0;  ///< of the exposure
  int width = 0;    ///< pixels
  int height = 0;   ///< pixels
  std::vector<std::uint8_t> jpeg;
};

/// One picture of depths along a camera's optical axis, row by row from the top.
struct DepthImage {
  Utime utime = 0;                      ///< of the exposure
  int width = 0;                        ///< pixels
  int height = 0;                       ///< pixels
  std::vector<std::uint16_t> depth_mm;  ///< 0: nothing was measured
};

/// Whoever reads a map of more cells of a room's floor is not on time any more.
inline constexpr double kMostMapCells = 1e6;

/// What stands still: the content of an OctoMap .bt file.
struct OccupancyMap {
  Utime utime = 0;
  std::string vehicle;
  double resolution_m = 0.05;
  std::vector<std::uint8_t> tree;
};

/// Dead reckoning by a ground robot's wheels.
struct Odometry {
  Utime utime = 0;
  std::string vehicle;
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  double heading_world_rad = 0.0;
  double speed_mps = 0.0;
  double turn_rate_radps = 0.0;
};

}  // namespace roundabout::core
