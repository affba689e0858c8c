#include "common/core/polygon.h"

#include <algorithm>
#include <cmath>

namespace roundabout::core {

namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

const Vector2d& cornerAfter(const Polygon& polygon, std::size_t i) {
  return polygon[(i + 1) % polygon.size()];
}

/// Positive: c lies to the left of the way from a to b.
double side(const Vector2d& a, const Vector2d& b, const Vector2d& c) { return cross(b - a, c - a); }

Vector2d nearestOnSegment(const Vector2d& a, const Vector2d& b, const Vector2d& place) {
  const Vector2d way = b - a;
  const double length_squared = way.squaredNorm();
  const double along =
      length_squared > 0.0 ? std::clamp((place - a).dot(way) / length_squared, 0.0, 1.0) : 0.0;
  return a + along * way;
}

double distanceToSegment(const Vector2d& a, const Vector2d& b, const Vector2d& place) {
  return (place - nearestOnSegment(a, b, place)).norm();
}

bool segmentsTouch(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const bool crossing = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
  return crossing || distanceToSegment(a, b, c) == 0.0 || distanceToSegment(a, b, d) == 0.0 ||
         distanceToSegment(c, d, a) == 0.0 || distanceToSegment(c, d, b) == 0.0;
}

/// Neighbours share the corner b; they may not fold back onto each other.
bool foldsBack(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return a == b || b == c || (side(a, b, c) == 0.0 && (a - b).dot(c - b) > 0.0);
}

}  // namespace

double signedArea(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    twice += cross(polygon[i], cornerAfter(polygon, i));
  }
  return 0.5 * twice;
}

bool isSimple(const Polygon& polygon) {
  const std::size_t count = polygon.size();
  if (count < 3) {
    return false;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = cornerAfter(polygon, i);
    if (foldsBack(a, b, cornerAfter(polygon, i + 1))) {
      return false;
    }
    for (std::size_t j = i + 2; j < count; ++j) {
      const bool neighbours = i == 0 && j == count - 1;
      if (!neighbours && segmentsTouch(a, b, polygon[j], cornerAfter(polygon, j))) {
        return false;
      }
    }
  }
  return true;
}

bool isConvex(const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (side(polygon[i], cornerAfter(polygon, i), cornerAfter(polygon, i + 1)) < 0.0) {
      return false;
    }
  }
  return true;
}

// Andrew's monotone chain (1979): the lower side from left to right, then the upper one back.
Polygon convexHull(std::vector<Vector2d> points) {
  const auto leftToRight = [](const Vector2d& a, const Vector2d& b) {
    return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
  };
  std::sort(points.begin(), points.end(), leftToRight);
  Polygon hull;
  const auto addSide = [&hull](auto begin, auto end) {
    const std::size_t first = hull.size();
    for (auto point = begin; point != end; ++point) {
      while (hull.size() >= first + 2 &&
             side(hull[hull.size() - 2], hull[hull.size() - 1], *point) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(*point);
    }
    hull.pop_back();  // the other side begins there
  };
  addSide(points.begin(), points.end());
  addSide(points.rbegin(), points.rend());
  return hull;
}

bool contains(const Polygon& polygon, const Vector2d& place_m) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = cornerAfter(polygon, i);
    // A ray to the right crosses sides once more from inside than from outside.
    if ((a.y() > place_m.y()) != (b.y() > place_m.y())) {
      const bool leftwards = b.y() < a.y();
      inside ^= (side(a, b, place_m) > 0.0) != leftwards;
    }
  }
  return inside;
}

Vector2d nearestOnOutline(const Polygon& polygon, const Vector2d& place_m) {
  Vector2d nearest = polygon.front();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d found = nearestOnSegment(polygon[i], cornerAfter(polygon, i), place_m);
    if ((found - place_m).squaredNorm() < (nearest - place_m).squaredNorm()) {
      nearest = found;
    }
  }
  return nearest;
}

double distanceTo(const Polygon& polygon, const Vector2d& place_m) {
  const double distance_m = (nearestOnOutline(polygon, place_m) - place_m).norm();
  return contains(polygon, place_m) ? -distance_m : distance_m;
}

}  // namespace roundabout::core
