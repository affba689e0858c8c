#include "planner/linear_program/velocity_obstacle.h"

#include <cmath>

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;

// Shorter vectors have no direction worth the name. m, m/s.
constexpr double kTiny = 1e-12;

// Out of the arc: the discs shall not touch at the end of the window.
std::optional<Escape> escapeFromArc(const Vector2d& position, const Vector2d& from_centre,
                                    double radius, double window_s) {
  const double distance = from_centre.norm();
  if (distance > kTiny) {
    return Escape{from_centre / distance, radius / window_s - distance};
  }
  if (position.norm() > kTiny) {
    return Escape{-position.normalized(), radius / window_s};
  }
  return std::nullopt;
}

// Out of the nearer leg of the cone.
Escape escapeFromLeg(const Vector2d& position, const Vector2d& velocity, double radius) {
  const double distance_squared = position.squaredNorm();
  const double leg = std::sqrt(distance_squared - radius * radius);
  const bool left = position.x() * velocity.y() - position.y() * velocity.x() > 0.0;
  const Vector2d forward = position / distance_squared;
  const Vector2d sideways = Vector2d(-forward.y(), forward.x()) * (left ? 1.0 : -1.0);
  // The leg's direction, forward * leg + sideways * radius, turned outwards by a right angle.
  const Vector2d normal = sideways * leg - forward * radius;
  return {normal, -normal.dot(velocity)};
}

}  // namespace

std::optional<Escape> escapeFrom(const Vector2d& relative_position_m,
                                 const Vector2d& relative_velocity_mps, double combined_radius_m,
                                 double time_horizon_s, double time_step_s) {
  const bool overlap = relative_position_m.norm() <= combined_radius_m;
  const double window_s = overlap ? time_step_s : time_horizon_s;
  const Vector2d from_centre = relative_velocity_mps - relative_position_m / window_s;
  // The arc ends where the legs touch it: as seen from its centre, at an angle of cosine
  // radius / distance from the direction to the apex.
  const bool faces_apex =
      -from_centre.dot(relative_position_m) >= combined_radius_m * from_centre.norm();
  if (overlap || faces_apex) {
    return escapeFromArc(relative_position_m, from_centre, combined_radius_m, window_s);
  }
  return escapeFromLeg(relative_position_m, relative_velocity_mps, combined_radius_m);
}

}  // namespace roundabout::planner
