#include <algorithm>
#include <cmath>

#include "common/core/polygon.h"
#include "sim/pedestrians/steering.h"

namespace roundabout::sim {

namespace {

using Eigen::Vector2d;

constexpr double kRelaxationS = 0.5;
constexpr double kStrength = 2.1;  // m^2/s^2
constexpr double kRangeM = 0.3;
constexpr double kStepS = 2.0;          // of others, ahead of them
constexpr double kWallStrength = 10.0;  // m^2/s^2
constexpr double kWallRangeM = 0.2;
constexpr double kHalfSightCosine = -0.1736;  // 100 degrees to either side
constexpr double kOutOfSight = 0.5;
constexpr double kMostOfWish = 1.3;  // times the preferred speed
// In the paper people are points; a radius that differs from a person's counts as less distance.
constexpr double kPersonRadiusM = 0.25;
constexpr double kNearestM = 0.05;
// Of bodies that nearly touch (Helbing, Farkas, Vicsek, "Simulating dynamical features of escape
// panic", Nature 407, 2000: 2000 N on 80 kg, and its range): nobody walks into anything with open
// eyes, however little it minds.
constexpr double kContactMps2 = 25.0;
constexpr double kContactRangeM = 0.08;

// Of a person at `apart` from another one, who moves with `other_mps`. m/s^2.
Vector2d repulsion(Vector2d apart, double radius_m, const Vector2d& other_mps) {
  const double distance_m = std::max(apart.norm(), kNearestM);
  apart *= std::max(distance_m - (radius_m - kPersonRadiusM), kNearestM) / distance_m;
  const Vector2d step = kStepS * other_mps;
  const Vector2d behind = apart - step;
  const double sum = apart.norm() + behind.norm();
  const double minor =
      std::max(kNearestM, 0.5 * std::sqrt(std::max(0.0, sum * sum - step.squaredNorm())));
  // The gradient of the half minor axis b: (|r| + |r - y|) (r/|r| + (r - y)/|r - y|) / 4b.
  const Vector2d gradient = sum / (4.0 * minor) * (apart.normalized() + behind.normalized());
  return kStrength / kRangeM * std::exp(-minor / kRangeM) * gradient;
}

// relative: of the person against the other one; it goes on so until it has reacted.
Vector2d contact(const Vector2d& apart, const Vector2d& relative_mps, double radii_m) {
  const double now_m = std::max(apart.norm(), kNearestM);
  const Vector2d away = apart / now_m;
  const double nearer_m = SocialForce::kReactionS * std::max(0.0, -relative_mps.dot(away));
  const double strength = kContactMps2 * std::exp((radii_m - now_m + nearer_m) / kContactRangeM);
  return std::min(strength, kContactMps2) * away;
}

}  // namespace

Vector2d SocialForce::velocity(const core::EgoAgent& person,
                               std::span<const core::OtherAgent> others, std::size_t vehicles,
                               double cooperation, std::span<const core::Polygon> obstacles) {
  const Vector2d way = person.goal_world_m - person.position_world_m;
  const Vector2d ahead = way.norm() > kNearestM ? Vector2d(way.normalized()) : Vector2d::Zero();
  Vector2d force = (person.preferred_speed_mps * ahead - person.velocity_world_mps) / kRelaxationS;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const core::OtherAgent& other = others[i];
    const Vector2d repelled = repulsion(person.position_world_m - other.position_world_m,
                                        other.radius_m, other.velocity_world_mps);
    const bool seen = ahead.dot(-repelled) >= kHalfSightCosine * repelled.norm();
    const bool vehicle = i + vehicles >= others.size();
    force += (seen ? 1.0 : kOutOfSight) * (vehicle ? cooperation : 1.0) * repelled;
    if (seen && (!vehicle || cooperation > 0.0)) {
      force += contact(person.position_world_m - other.position_world_m,
                       person.velocity_world_mps - other.velocity_world_mps,
                       person.radius_m + other.radius_m);
    }
  }
  for (const core::Polygon& obstacle : obstacles) {
    const Vector2d away =
        person.position_world_m - core::nearestOnOutline(obstacle, person.position_world_m);
    const double distance_m = std::max(away.norm(), kNearestM);
    force += kWallStrength / kWallRangeM * std::exp(-(distance_m - person.radius_m) / kWallRangeM) *
             std::exp(-person.radius_m / kWallRangeM) * away / distance_m;
  }
  const Vector2d velocity = person.velocity_world_mps + kPeriodS * force;
  const double most_mps = kMostOfWish * person.preferred_speed_mps;
  return velocity.norm() > most_mps ? Vector2d(velocity * (most_mps / velocity.norm())) : velocity;
}

}  // namespace roundabout::sim
