#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "perception/clustering/clusterer.h"

namespace roundabout::perception {

/// Segments up to this wide may be one leg.
inline constexpr double kWidestLeg_m = 0.32;

/// One body as one sweep shows it.
struct Detection {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< of its middle, world
  double deviation_m = 0.1;   ///< standard deviation of the position per axis
  double half_width_m = 0.1;  ///< of what was seen, at least
  int legs = 0;               ///< 1 or 2; 0: something wider than a leg
  bool hidden = false;        ///< what is nearer may hide a part of it
  std::vector<std::size_t> beams;
};

/// Where the middle of a round body is whose front a segment is, world.
Eigen::Vector2d surfaceCentre(const ScanPoints& points, const Segment& segment);

/// What a cluster of `segments` says of a body.
Detection detectionOf(const ScanPoints& points, std::span<const Segment> segments,
                      const Cluster& cluster);

}  // namespace roundabout::perception
