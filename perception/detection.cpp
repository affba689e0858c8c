#include "perception/detection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace roundabout::perception {

namespace {

constexpr double kThinnestLeg_m = 0.04;  // radius
constexpr double kLegDeviation_m = 0.03;
// The middle of a person is this far from one leg alone, which goes fast and stands by turns.
constexpr double kOneLegDeviation_m = 0.15;
constexpr double kBodyDeviation_m = 0.06;
// A body of two legs that were not told apart is not deeper than this.
constexpr double kDeepest_m = 0.15;

Eigen::Vector2d middleOf(const ScanPoints& points, const Segment& segment) {
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  for (const std::size_t beam : segment.beams) {
    sum_m += points.world_m[beam];
  }
  return sum_m / static_cast<double>(segment.beams.size());
}

/// The width that beams at equal angles leave out at both ends, half a step each.
double fullWidth(const ScanPoints& points, const Segment& segment) {
  return segment.width_m + points.range_m[segment.beams.front()] * std::abs(points.angle_step_rad);
}

}  // namespace

Eigen::Vector2d surfaceCentre(const ScanPoints& points, const Segment& segment) {
  const Eigen::Vector2d middle_m = middleOf(points, segment);
  const double radius_m = std::clamp(fullWidth(points, segment) / 2.0, kThinnestLeg_m, kDeepest_m);
  // The mean depth of a circle's front.
  return middle_m + std::numbers::pi / 4.0 * radius_m * (middle_m - points.sensor_m).normalized();
}

Detection detectionOf(const ScanPoints& points, std::span<const Segment> segments,
                      const Cluster& cluster) {
  Detection detection;
  bool all_legs = true;
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  for (const std::size_t index : cluster) {
    const Segment& segment = segments[index];
    sum_m += surfaceCentre(points, segment);
    all_legs = all_legs && segment.width_m <= kWidestLeg_m;
    detection.hidden = detection.hidden || segment.hidden_begin || segment.hidden_end;
    detection.beams.insert(detection.beams.end(), segment.beams.begin(), segment.beams.end());
  }
  detection.position_m = sum_m / static_cast<double>(cluster.size());
  for (const std::size_t index : cluster) {
    const double from_middle_m =
        (surfaceCentre(points, segments[index]) - detection.position_m).norm();
    detection.half_width_m =
        std::max(detection.half_width_m, from_middle_m + fullWidth(points, segments[index]) / 2.0);
  }
  detection.legs = all_legs && cluster.size() <= 2 ? static_cast<int>(cluster.size()) : 0;
  const double spacing_m =
      points.range_m[detection.beams.front()] * std::abs(points.angle_step_rad);
  const double shape_m = detection.legs == 2   ? kLegDeviation_m
                         : detection.legs == 1 ? kOneLegDeviation_m
                                               : kBodyDeviation_m;
  detection.deviation_m = std::hypot(shape_m, spacing_m / 2.0);
  return detection;
}

}  // namespace roundabout::perception
