#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "planner/shield/convex_gap.h"

namespace roundabout::planner::shield {

/// Something to go round: a point or the corners of a convex polygon, and how far the way keeps
/// from it.
struct Hindrance {
  std::vector<Eigen::Vector2d> corners_m;
  double apart_m = 0.0;
};

/// Shortest ways round hindrances: a visibility graph of decagons round their corners. Only
/// hindrances that are in the way take part.
class WayRound {
 public:
  /// Waypoints from `from` to `to`, the last included. Nothing if there is no way. A start or an
  /// end that is too near to a hindrance makes it smaller.
  std::optional<std::vector<Eigen::Vector2d>> find(const Eigen::Vector2d& from,
                                                   const Eigen::Vector2d& to,
                                                   std::span<const Hindrance> hindrances);

  /// Whether a way keeps off all of them.
  static bool isFree(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                     std::span<const Hindrance> hindrances);

 private:
  struct Node {
    Eigen::Vector2d place;
    double cost_m;
    int before;
    bool settled;
  };

  void addDecagons(const Hindrance& hindrance);
  bool search(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  bool addBlocking(const std::vector<Eigen::Vector2d>& way);

  std::vector<Hindrance> all_;
  std::vector<bool> used_;
  std::vector<Hindrance> chosen_;
  std::vector<Eigen::Vector2d> corners_;
  std::vector<Node> nodes_;
};

/// m
double lengthOf(const Eigen::Vector2d& from, const std::vector<Eigen::Vector2d>& way);

}  // namespace roundabout::planner::shield
