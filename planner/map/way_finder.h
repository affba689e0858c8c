#pragma once

#include <optional>
#include <vector>

#include "common/core/agent.h"
#include "planner/map/occupancy_grid.h"

namespace roundabout::planner {

/// Finds the way round what the map knows, for policies that know only where they want to go.
class WayFinder {
 public:
  struct Settings {
    double body_radius_m = 0.3;
    double margin_m = 0.1;  ///< between body and map, at least
  };

  WayFinder(const Settings& settings, OccupancyGrid grid);

  /// Whether a body that goes straight from one place to another keeps body radius and margin from
  /// everything in the map. Outside the map everything is free. A body that is nearer already may
  /// go where it does not come nearer still.
  bool freeBetween(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const;

  struct Leg {
    Eigen::Vector2d place_m;  ///< where to go first
    double way_left_m;        ///< of the whole way, from here
  };

  /// To the goal itself if the way there is free, else to the farthest place on the shortest way
  /// (A*) that can be reached in a straight line. Nothing if there is no way.
  std::optional<Leg> nextLeg(const Eigen::Vector2d& from_m, const Eigen::Vector2d& goal_m) const;

  /// The shortest way over cells, from, to; empty: there is none. Keeps in the middle of gaps where
  /// that costs little.
  std::vector<Eigen::Vector2d> way(const Eigen::Vector2d& from_m,
                                   const Eigen::Vector2d& goal_m) const;

  /// The velocity itself if the body can fly it for so long; else the same speed, then half of it,
  /// in the nearest direction in which it can; else zero.
  Eigen::Vector2d maskedVelocity(const Eigen::Vector2d& from_m, const Eigen::Vector2d& velocity_mps,
                                 double look_ahead_s) const;

  /// What stands within reach, as one convex polygon for each of twelve directions: the hull of the
  /// occupied cells that are nearest in each three degrees of it. A straight line that has them and
  /// the place on its two sides has every occupied cell within reach beyond it, but for what three
  /// degrees hide: a cell may stick out by 5 cm at a metre.
  void nearestCells(const Eigen::Vector2d& place_m, double reach_m,
                    std::vector<core::Polygon>& cells) const;

 private:
  double clearanceAt(const Eigen::Vector2d& place_m) const;
  double costOf(const OccupancyGrid::Cell& cell, double start_clearance_m) const;

  double keep_m_;  // from the centre of an occupied cell
  double comfort_m_;
  OccupancyGrid grid_;
  std::vector<float> clearance_m_;
};

}  // namespace roundabout::planner
