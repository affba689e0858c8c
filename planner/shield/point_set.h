#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace roundabout::planner::shield {

using Points = std::span<const Eigen::Vector2d>;

/// Points of which the farthest along a direction is asked for often: x and y are kept apart.
class PointSet {
 public:
  void clear();
  void append(Points points);

  /// With so many at least: copies of the last point, of which there is one.
  void extendTo(std::size_t size);

  std::size_t size() const { return size_; }
  std::span<const double> xs() const { return {x_.data(), size_}; }
  std::span<const double> ys() const { return {y_.data(), size_}; }
  Eigen::Vector2d operator[](std::size_t i) const { return {x_[i], y_[i]}; }
  Eigen::Vector2d front() const { return (*this)[0]; }

  /// Greatest normal . p. Of an empty set: minus infinity.
  double extentAlong(const Eigen::Vector2d& normal) const;

  /// Where that is; the first of equals. Not empty.
  Eigen::Vector2d farthestAlong(const Eigen::Vector2d& direction) const;

 private:
  std::size_t size_ = 0;
  std::vector<double> x_;  // filled up with copies of the last point
  std::vector<double> y_;
};

}  // namespace roundabout::planner::shield
