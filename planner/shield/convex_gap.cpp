#include "planner/shield/convex_gap.h"

#include <algorithm>
#include <array>
#include <limits>

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

constexpr int kMostIterations = 32;
// Relative to the squared distance.
constexpr double kTolerance = 1e-12;
// Nearer, hulls count as touching. m².
constexpr double kTouching_m2 = 1e-18;

Vector2d farthest(const PointSet& points, const Vector2d& direction) {
  return points.farthestAlong(direction);
}

Vector2d farthest(Points points, const Vector2d& direction) {
  double greatest = -std::numeric_limits<double>::infinity();
  Vector2d best = points.front();
  for (const Vector2d& point : points) {
    const double along = direction.dot(point);
    if (along > greatest) {
      greatest = along;
      best = point;
    }
  }
  return best;
}

Vector2d nearestToOrigin(const Vector2d& a, const Vector2d& b) {
  const Vector2d way = b - a;
  const double length_squared = way.squaredNorm();
  const double share =
      length_squared > 0.0 ? std::clamp(-a.dot(way) / length_squared, 0.0, 1.0) : 0.0;
  return a + share * way;
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool holdsOrigin(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double ab = cross(b - a, -a);
  const double bc = cross(c - b, -b);
  const double ca = cross(a - c, -c);
  return (ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0);
}

template <class Set>
Vector2d centreOf(const Set& points) {
  Vector2d sum = Vector2d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += points[i];
  }
  return sum / static_cast<double>(points.size());
}

template <class First, class Second>
ConvexGap alongCentres(const First& first, const Second& second) {
  const Vector2d way = centreOf(second) - centreOf(first);
  const double length = way.norm();
  ConvexGap gap;
  if (length > 0.0) {
    gap.normal = way / length;
  }
  gap.distance_m =
      gap.normal.dot(farthest(second, -gap.normal)) - gap.normal.dot(farthest(first, gap.normal));
  return gap;
}

template <class First, class Second>
ConvexGap nearestPlaces(const First& first, const Second& second) {
  // The nearest point to the origin of the set of all differences, by growing a segment of it.
  const auto difference = [&](const Vector2d& direction) {
    return Vector2d(farthest(second, -direction) - farthest(first, direction));
  };
  Vector2d a = second.front() - first.front();
  Vector2d b = a;
  Vector2d nearest = a;
  for (int i = 0; i < kMostIterations; ++i) {
    const double distance_squared = nearest.squaredNorm();
    if (distance_squared <= kTouching_m2) {
      return alongCentres(first, second);
    }
    const Vector2d c = difference(nearest);
    if (distance_squared - nearest.dot(c) <= kTolerance * distance_squared) {
      break;
    }
    if (holdsOrigin(a, b, c)) {
      return alongCentres(first, second);
    }
    const Vector2d on_ac = nearestToOrigin(a, c);
    const Vector2d on_bc = nearestToOrigin(b, c);
    const bool keeps_a = on_ac.squaredNorm() <= on_bc.squaredNorm();
    nearest = keeps_a ? on_ac : on_bc;
    (keeps_a ? b : a) = c;
  }
  const double distance_m = nearest.norm();
  return {nearest / distance_m, distance_m};
}

}  // namespace

double extentAlong(Points points, const Vector2d& normal) {
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Vector2d& point : points) {
    greatest = std::max(greatest, normal.dot(point));
  }
  return greatest;
}

ConvexGap gapBetween(Points first, Points second) { return nearestPlaces(first, second); }

ConvexGap gapBetween(const PointSet& first, Points second) { return nearestPlaces(first, second); }

ConvexGap gapBetween(const PointSet& first, const PointSet& second) {
  return nearestPlaces(first, second);
}

}  // namespace roundabout::planner::shield
