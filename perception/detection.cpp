#include "perception/detection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace roundabout::perception {

namespace {

constexpr double kThinnestLeg_m = 0.04;  // radius
constexpr double kThickestLeg_m = 0.07;  // radius
// A body of two legs that were not told apart is not deeper than this.
constexpr double kDeepest_m = 0.15;
// Wider segments are two legs, one partly behind the other or too near to it to be told apart.
constexpr double kOneLeg_m = 0.2;
// Standard deviations of where the middle is.
constexpr double kTwoLegsDeviation_m = 0.03;
constexpr double kBodyDeviation_m = 0.06;
// The other leg is behind the only one that is seen, so the middle is this much farther away; one
// leg goes fast and stands by turns.
constexpr double kBehindOneLeg_m = 0.1;
constexpr double kOneLegDepthDeviation_m = 0.12;
constexpr double kOneLegSidewaysDeviation_m = 0.08;
// Or somebody else hides the other leg, and it is anywhere.
constexpr double kHiddenLegDeviation_m = 0.15;

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

/// What is known of a place from its bearing and its distance.
Eigen::Matrix2d covarianceAlong(const Eigen::Vector2d& ray, double depth_m, double sideways_m) {
  const Eigen::Vector2d across(-ray.y(), ray.x());
  return depth_m * depth_m * ray * ray.transpose() +
         sideways_m * sideways_m * across * across.transpose();
}

void setCovariance(const ScanPoints& points, Detection& detection) {
  const Eigen::Vector2d ray = (detection.position_m - points.sensor_m).normalized();
  double depth_m = detection.legs == 2 ? kTwoLegsDeviation_m : kBodyDeviation_m;
  double sideways_m = depth_m;
  if (detection.legs == 1 && detection.hidden) {
    depth_m = sideways_m = kHiddenLegDeviation_m;
  } else if (detection.legs == 1) {
    depth_m = kOneLegDepthDeviation_m;
    sideways_m = kOneLegSidewaysDeviation_m;
    detection.position_m += kBehindOneLeg_m * ray;
  }
  const double half_spacing_m =
      points.range_m[detection.beams.front()] * std::abs(points.angle_step_rad) / 2.0;
  detection.covariance_m2 = covarianceAlong(ray, std::hypot(depth_m, half_spacing_m),
                                            std::hypot(sideways_m, half_spacing_m));
}

}  // namespace

Eigen::Vector2d surfaceCentre(const ScanPoints& points, const Segment& segment) {
  const Eigen::Vector2d middle_m = middleOf(points, segment);
  const double deepest_m = segment.width_m <= kWidestLeg_m ? kThickestLeg_m : kDeepest_m;
  const double radius_m = std::clamp(fullWidth(points, segment) / 2.0, kThinnestLeg_m, deepest_m);
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
  const Segment& first = segments[cluster.front()];
  const bool beside = !detection.hidden && fullWidth(points, first) > kOneLeg_m;
  detection.legs = !all_legs || cluster.size() > 2 ? 0 : cluster.size() == 2 || beside ? 2 : 1;
  setCovariance(points, detection);
  return detection;
}

}  // namespace roundabout::perception
