#include "perception/scan/scan_points.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "common/core/angles.h"

namespace roundabout::perception {

PlanarPose between(const PlanarPose& from, const PlanarPose& to, double share) {
  return {from.position_m + share * (to.position_m - from.position_m),
          from.heading_rad + share * core::wrapToPi(to.heading_rad - from.heading_rad)};
}

std::size_t ScanPoints::beamAt(double bearing_rad) const {
  if (hit.empty() || angle_step_rad == 0.0) {
    return size();
  }
  // Bearings count in the direction in which the beams follow each other.
  const double turn = 2.0 * std::numbers::pi;
  double ahead_rad = std::fmod(bearing_rad - first_bearing_rad, turn);
  if (angle_step_rad > 0.0 && ahead_rad < -angle_step_rad / 2.0) {
    ahead_rad += turn;
  } else if (angle_step_rad < 0.0 && ahead_rad > -angle_step_rad / 2.0) {
    ahead_rad -= turn;
  }
  const double beam = std::round(ahead_rad / angle_step_rad);
  return beam >= 0.0 && beam < static_cast<double>(size()) ? static_cast<std::size_t>(beam)
                                                           : size();
}

bool usableRange(float range_m) { return range_m >= 0.0F; }

int toPoints(const core::LaserScan& scan, const PlanarPose& begin, const PlanarPose& end,
             const RangeLimits& limits, ScanPoints& points) {
  const std::size_t beams = scan.ranges_m.size();
  points.utime = scan.utime;
  points.sensor_m = end.position_m;
  points.angle_step_rad = scan.angle_step_rad;
  points.first_bearing_rad = end.heading_rad + scan.first_angle_rad;
  points.full_circle = static_cast<double>(beams) * std::abs(scan.angle_step_rad) >=
                       2.0 * std::numbers::pi - 0.5 * std::abs(scan.angle_step_rad);
  points.world_m.resize(beams);
  points.range_m.resize(beams);
  points.hit.resize(beams);
  int unusable = 0;
  for (std::size_t i = 0; i < beams; ++i) {
    const float measured_m = scan.ranges_m[i];
    const bool usable = usableRange(measured_m);
    unusable += usable ? 0 : 1;
    const double range_m = usable ? std::min<double>(measured_m, limits.max_m) : limits.max_m;
    const double share = beams < 2 ? 1.0 : static_cast<double>(i) / static_cast<double>(beams - 1);
    const PlanarPose pose = between(begin, end, share);
    const double bearing_rad =
        pose.heading_rad + scan.first_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
    points.range_m[i] = range_m;
    points.hit[i] = usable && range_m >= limits.min_m && range_m < limits.max_m ? 1 : 0;
    points.world_m[i] =
        pose.position_m + range_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
  }
  return unusable;
}

}  // namespace roundabout::perception
