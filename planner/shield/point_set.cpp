#include "planner/shield/point_set.h"

#include <algorithm>
#include <limits>

#include "planner/shield/lanes.h"

namespace roundabout::planner::shield {

using Eigen::Vector2d;

namespace {

std::size_t filledUp(std::size_t size) { return (size + kLanes - 1) / kLanes * kLanes; }

}  // namespace

void PointSet::clear() {
  size_ = 0;
  x_.clear();
  y_.clear();
}

void PointSet::append(Points points) {
  if (points.empty()) {
    return;
  }
  const std::size_t filled = filledUp(size_ + points.size());
  x_.resize(filled);
  y_.resize(filled);
  for (const Vector2d& point : points) {
    x_[size_] = point.x();
    y_[size_] = point.y();
    ++size_;
  }
  std::fill(x_.begin() + static_cast<std::ptrdiff_t>(size_), x_.end(), points.back().x());
  std::fill(y_.begin() + static_cast<std::ptrdiff_t>(size_), y_.end(), points.back().y());
}

void PointSet::extendTo(std::size_t size) {
  if (size > size_) {
    const Vector2d last = (*this)[size_ - 1];
    size_ = size;
    x_.resize(filledUp(size_), last.x());
    y_.resize(filledUp(size_), last.y());
  }
}

double PointSet::extentAlong(const Vector2d& normal) const {
  Lanes greatest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < x_.size(); i += kLanes) {
    greatest = max(greatest, normal.x() * loadLanes(&x_[i]) + normal.y() * loadLanes(&y_[i]));
  }
  return hmax(greatest);
}

Vector2d PointSet::farthestAlong(const Vector2d& direction) const {
  const double extent = extentAlong(direction);
  for (std::size_t i = 0; i < x_.size(); i += kLanes) {
    const LaneMask there =
        direction.x() * loadLanes(&x_[i]) + direction.y() * loadLanes(&y_[i]) == extent;
    if (any_of(there)) {
      return (*this)[i + static_cast<std::size_t>(find_first_set(there))];
    }
  }
  return (*this)[size_ - 1];  // not a number
}

}  // namespace roundabout::planner::shield
