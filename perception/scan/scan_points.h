#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "common/core/laser_scan.h"

namespace roundabout::perception {

/// Where a vehicle is in the floor plane. World frame.
struct PlanarPose {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;
};

/// What lies between two poses, the shorter way round; share 0: from, 1: to.
PlanarPose between(const PlanarPose& from, const PlanarPose& to, double share);

/// The beams of one sweep as places in the world, in the order of the beams.
struct ScanPoints {
  core::Utime utime = 0;
  Eigen::Vector2d sensor_m = Eigen::Vector2d::Zero();  ///< world, at the end of the sweep
  double angle_step_rad = 0.0;
  double first_bearing_rad = 0.0;  ///< of beam 0, in the world, by the pose at the end
  bool full_circle = false;        ///< the last beam is the first one's neighbour
  std::vector<Eigen::Vector2d>
      world_m;  ///< of what was hit; where nothing was: the end of the beam
  std::vector<double> range_m;
  std::vector<std::uint8_t> hit;

  std::size_t size() const { return hit.size(); }
  /// The beam nearest to a direction in the world, or size() if none looks there.
  std::size_t beamAt(double bearing_rad) const;
};

struct RangeLimits {
  double min_m = 0.05;  ///< what is nearer is the vehicle itself
  double max_m = 10.0;  ///< what is farther is not looked at
};

/// Ranges that are NaN, negative or minus infinity are no measurements; infinity and what is at
/// the maximum range or beyond hit nothing.
bool usableRange(float range_m);

/// Sorts a sweep's beams into `points`. The first beam was measured at the pose `begin`, the last
/// at `end`, those between at poses in between. Returns how many ranges were not usable.
int toPoints(const core::LaserScan& scan, const PlanarPose& begin, const PlanarPose& end,
             const RangeLimits& limits, ScanPoints& points);

}  // namespace roundabout::perception
