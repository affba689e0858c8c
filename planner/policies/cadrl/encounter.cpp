#include "planner/policies/cadrl/encounter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/angles.h"

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;

constexpr double kLongestS = 1.0;
constexpr double kLargestSine = 0.95;
// Slower than this, a velocity counts as none.
constexpr double kStandingMps = 1e-5;

double angleOf(const Vector2d& vector) { return std::atan2(vector.y(), vector.x()); }

/// The other one's velocity as the ego reckons with it: reduced along the ego's own motion if the
/// other one is in front and goes the same way.
Vector2d reckonedVelocity(const core::OtherAgent& other, const core::EgoAgent& ego,
                          const Vector2d& own_velocity) {
  const Vector2d offset = other.position_world_m - ego.position_world_m;
  const double reach_m = ego.radius_m + other.radius_m + kCadrlCloseM;
  const double cone_rad = std::asin(std::min(kLargestSine, reach_m / offset.norm()));
  const double own_angle_rad = angleOf(own_velocity);
  const bool in_front = std::abs(core::wrapToPi(own_angle_rad - angleOf(offset))) < cone_rad;
  const bool same_way =
      std::abs(core::wrapToPi(own_angle_rad - angleOf(other.velocity_world_mps))) <
      std::numbers::pi / 2.0;
  if (!in_front || !same_way) {
    return other.velocity_world_mps;
  }
  // Units do not fit, and which way is +x matters: this is what the published code does, and what
  // its results are made with.
  double factor = own_velocity.dot(other.velocity_world_mps);
  if (own_velocity.x() > kStandingMps) {
    factor /= own_velocity.norm();
  }
  return other.velocity_world_mps - factor / 2.0 * own_velocity;
}

/// Norm of offset + time * velocity at its minimum within the duration, else at its end.
double closestApproach(const Vector2d& offset, const Vector2d& velocity, double duration) {
  const double end = (offset + duration * velocity).norm();
  const double squared_speed = velocity.squaredNorm();
  const double time = squared_speed > 0.0 ? -offset.dot(velocity) / squared_speed : 0.0;
  return time > 0.0 && time < duration ? std::min(end, (offset + time * velocity).norm()) : end;
}

}  // namespace

Encounter encounterWith(const core::OtherAgent& other, const core::EgoAgent& ego,
                        const Candidate& candidate, double duration_s) {
  const Vector2d offset = other.position_world_m - ego.position_world_m;
  const double combined_m = ego.radius_m + other.radius_m;
  const double distance_m = offset.norm();
  const double reach_m =
      (ego.preferred_speed_mps + other.velocity_world_mps.norm()) * duration_s + combined_m;
  if (distance_m > reach_m) {
    return {combined_m + kCadrlCloseM, false};
  }
  const Vector2d velocity =
      reckonedVelocity(other, ego, candidate.velocity_world_mps) - candidate.velocity_world_mps;
  const double gap_m =
      closestApproach(offset, velocity, std::min(kLongestS, duration_s)) - combined_m;
  return {gap_m, gap_m < 0.0 || distance_m < combined_m};
}

}  // namespace roundabout::planner
