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
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();                ///< of its middle, world
  Eigen::Matrix2d covariance_m2 = 0.01 * Eigen::Matrix2d::Identity();  ///< of the position, world
  double half_width_m = 0.1;  ///< of what was seen, at least
  int legs = 0;               ///< 1 or 2, in one segment or two; 0: something wider
  bool hidden = false;        ///< what is nearer may hide a part of it
  std::vector<std::size_t> beams;
};

/// Where the middle of a round body is whose front a segment is, world; of segments no wider than
/// kWidestLeg_m, the middle of a leg, or of two beside each other.
Eigen::Vector2d surfaceCentre(const ScanPoints& points, const Segment& segment);

/// What a cluster of `segments` says of a body.
Detection detectionOf(const ScanPoints& points, std::span<const Segment> segments,
                      const Cluster& cluster);

}  // namespace roundabout::perception
