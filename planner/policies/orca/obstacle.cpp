#include "planner/policies/orca/obstacle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace roundabout::planner {

// The obstacle is the convex set P, h(n) = max over its corners of n . corner its support function.
// A unit vector n parts the disc from it if h(n) <= -radius. The velocity obstacle is the union of
// (P + disc) / t over all t up to the horizon. It is convex, and beyond the line n . v =
// (h(n) + radius) / horizon for every n that parts them; there are no other tangents. The tangent
// at the point nearest to the disc's velocity is that of greatest distance n . v - (h(n) + radius)
// / horizon, be the velocity inside (the distance is then negative) or outside.

namespace {

using Eigen::Vector2d;

// Shorter vectors have no direction worth the name. m, m/s.
constexpr double kTiny = 1e-12;

double support(std::span<const Vector2d> corners, const Vector2d& normal) {
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Vector2d& corner : corners) {
    greatest = std::max(greatest, normal.dot(corner));
  }
  return greatest;
}

// Calls visit(unit vector) for the outward normal of every side.
template <class Visit>
void forEachSide(std::span<const Vector2d> corners, Visit visit) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d side = corners[(i + 1) % corners.size()] - corners[i];
    const double length = side.norm();
    if (length > kTiny) {
      visit(Vector2d(side.y() / length, -side.x() / length));
    }
  }
}

// Calls visit(unit vector) for the direction from every corner to a point.
template <class Visit>
void forEachCorner(std::span<const Vector2d> corners, double scale, const Vector2d& point,
                   Visit visit) {
  for (const Vector2d& corner : corners) {
    const Vector2d way = point - scale * corner;
    const double length = way.norm();
    if (length > kTiny) {
      visit(Vector2d(way / length));
    }
  }
}

struct Separation {
  Vector2d normal = Vector2d::Zero();  // from the nearest point of the obstacle to the origin
  double distance_m = -std::numeric_limits<double>::infinity();  // negative inside
};

Separation separationOf(std::span<const Vector2d> corners) {
  Separation best;
  const auto consider = [&](const Vector2d& normal) {
    const double distance = -support(corners, normal);
    if (distance > best.distance_m) {
      best = {normal, distance};
    }
  };
  forEachSide(corners, consider);
  forEachCorner(corners, 1.0, Vector2d::Zero(), consider);
  return best;
}

Vector2d rotated(const Vector2d& vector, double angle) {
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle);
  return {cosine * vector.x() - sine * vector.y(), sine * vector.x() + cosine * vector.y()};
}

// The two ends of the arc of unit vectors that part a disc from the obstacle, as angles from one
// vector inside the arc. Their tangents go through zero velocity: the legs.
struct Legs {
  double clockwise_rad;
  double counterclockwise_rad;
};

Legs legsOf(std::span<const Vector2d> corners, double radius, const Vector2d& inside) {
  Legs legs{-std::numbers::pi, std::numbers::pi};
  for (const Vector2d& corner : corners) {
    const double along = -corner.dot(inside);
    const double across = inside.y() * corner.x() - inside.x() * corner.y();
    const double middle = std::atan2(across, along);
    const double half_width = std::acos(std::min(1.0, radius / corner.norm()));
    legs.clockwise_rad = std::max(legs.clockwise_rad, middle - half_width);
    legs.counterclockwise_rad = std::min(legs.counterclockwise_rad, middle + half_width);
  }
  return legs;
}

}  // namespace

std::optional<HalfPlane> halfPlaneBeside(std::span<const Vector2d> corners_m,
                                         const DiscMotion& disc) {
  const Separation separation = separationOf(corners_m);
  const double gap_m = separation.distance_m - disc.radius_m;
  if (!std::isfinite(gap_m) || gap_m > disc.max_speed_mps * disc.horizon_s) {
    return std::nullopt;
  }
  if (gap_m <= 0.0) {
    return HalfPlane{separation.normal, 0.0};
  }

  std::optional<HalfPlane> best;
  double greatest_mps = -std::numeric_limits<double>::infinity();
  const auto considerTangent = [&](const Vector2d& normal, double offset_mps) {
    // Of equally near tangents the first stays, whatever rounding says.
    const double distance_mps = normal.dot(disc.velocity_mps) - offset_mps;
    if (distance_mps > greatest_mps + kTiny) {
      greatest_mps = distance_mps;
      best = HalfPlane{normal, offset_mps};
    }
  };
  const auto consider = [&](const Vector2d& normal) {
    const double nearest_m = support(corners_m, normal) + disc.radius_m;
    if (nearest_m <= 0.0) {
      considerTangent(normal, nearest_m / disc.horizon_s);
    }
  };
  const Legs legs = legsOf(corners_m, disc.radius_m, separation.normal);
  considerTangent(rotated(separation.normal, legs.counterclockwise_rad), 0.0);  // past it: right
  considerTangent(rotated(separation.normal, legs.clockwise_rad), 0.0);
  forEachSide(corners_m, consider);
  forEachCorner(corners_m, 1.0 / disc.horizon_s, disc.velocity_mps, consider);
  return best;
}

}  // namespace roundabout::planner
