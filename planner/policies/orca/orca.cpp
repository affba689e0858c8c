#include "planner/policies/orca/orca.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/angles.h"
#include "common/core/polygon.h"
#include "planner/linear_program/linear_program.h"
#include "planner/linear_program/velocity_obstacle.h"
#include "planner/policies/orca/obstacle.h"

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;

// Each of two agents makes half of the change that keeps them apart.
constexpr double kShare = 0.5;

// Slower is standing, and has no direction.
constexpr double kStandingMps = 1e-9;

// As fast as preferred, but not beyond the goal within a step.
Vector2d preferredVelocity(const core::EgoAgent& ego, double time_step_s) {
  const Vector2d to_goal = ego.goal_world_m - ego.position_world_m;
  const double distance = to_goal.norm();
  if (distance <= 0.0) {
    return Vector2d::Zero();
  }
  return to_goal / distance * std::min(ego.preferred_speed_mps, distance / time_step_s);
}

class Orca final : public Policy {
 public:
  explicit Orca(const config::Orca& options)
      : options_(options), turn_right_(-options.right_bias_rad) {}

  Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) override {
    collectNeighbours(ego, around.others);
    half_planes_.clear();
    reserve(around.obstacles);
    for (const core::Polygon& obstacle : around.obstacles) {
      addObstacle(ego, obstacle);
    }
    const std::size_t obstacle_count = half_planes_.size();
    for (const Neighbour& neighbour : neighbours_) {
      addHalfPlane(ego, *neighbour.agent);
    }
    Vector2d preferred = preferredVelocity(ego, options_.time_step_s);
    // Agents that meet symmetrically would stop in front of each other for good. If everybody who
    // cannot go straight leans to the same side they go round each other.
    if (!isFree(preferred)) {
      preferred = turn_right_ * preferred;
    }
    const VelocityChoice choice =
        program_.solve(half_planes_, preferred, ego.preferred_speed_mps, obstacle_count);
    return toDecision(ego, choice.velocity_mps);
  }

  std::unique_ptr<Policy> twin() const override { return std::make_unique<Orca>(options_); }

  bool avoidsObstacles() const override { return true; }
  std::string_view name() const override { return "orca"; }

 private:
  struct Neighbour {
    double distance_m;
    const core::OtherAgent* agent;

    // Ties are broken, so that the order in which others are given changes nothing.
    auto key() const {
      return std::tuple(distance_m, agent->position_world_m.x(), agent->position_world_m.y(),
                        agent->velocity_world_mps.x(), agent->velocity_world_mps.y(),
                        agent->radius_m);
    }
  };

  // The nearest, nearest first.
  void collectNeighbours(const core::EgoAgent& ego, std::span<const core::OtherAgent> others) {
    neighbours_.clear();
    for (const core::OtherAgent& other : others) {
      neighbours_.push_back({(other.position_world_m - ego.position_world_m).norm(), &other});
    }
    const std::size_t count =
        std::min(neighbours_.size(), static_cast<std::size_t>(options_.max_neighbours));
    std::partial_sort(neighbours_.begin(), neighbours_.begin() + static_cast<std::ptrdiff_t>(count),
                      neighbours_.end(),
                      [](const Neighbour& a, const Neighbour& b) { return a.key() < b.key(); });
    neighbours_.resize(count);
  }

  void addHalfPlane(const core::EgoAgent& ego, const core::OtherAgent& other) {
    const std::optional<Escape> escape =
        escapeFrom(other.position_world_m - ego.position_world_m,
                   ego.velocity_world_mps - other.velocity_world_mps,
                   options_.radius_factor * (ego.radius_m + other.radius_m),
                   options_.time_horizon_s, options_.time_step_s);
    if (escape) {
      half_planes_.push_back({escape->normal, escape->normal.dot(ego.velocity_world_mps) +
                                                  kShare * escape->depth_mps});
    }
  }

  // For every side of every obstacle, in reach or not.
  void reserve(std::span<const core::Polygon> obstacles) {
    std::size_t most = neighbours_.size();
    for (const core::Polygon& obstacle : obstacles) {
      most += obstacle.size();
      corners_.reserve(obstacle.size() + 1);
    }
    half_planes_.reserve(most);
    program_.reserve(most);
  }

  // A convex obstacle is avoided as a whole. Of another one every side that faces the ego is an
  // obstacle of its own: nothing is hit first from behind. Inside, only the shortest way out
  // counts.
  void addObstacle(const core::EgoAgent& ego, const core::Polygon& obstacle) {
    corners_.clear();
    for (const Vector2d& corner : obstacle) {
      corners_.push_back(corner - ego.position_world_m);
    }
    if (core::isConvex(obstacle)) {
      addConvexObstacle(ego, corners_);
      return;
    }
    if (core::contains(obstacle, ego.position_world_m)) {
      addWayOut(core::nearestOnOutline(obstacle, ego.position_world_m) - ego.position_world_m);
      return;
    }
    corners_.push_back(corners_.front());
    for (std::size_t i = 0; i < obstacle.size(); ++i) {
      const std::span<const Vector2d> side = std::span<const Vector2d>(corners_).subspan(i, 2);
      const bool faces_ego = side[0].x() * side[1].y() - side[0].y() * side[1].x() <= 0.0;
      if (faces_ego) {
        addConvexObstacle(ego, side);
      }
    }
  }

  void addConvexObstacle(const core::EgoAgent& ego, std::span<const Vector2d> corners) {
    const std::optional<HalfPlane> half_plane =
        halfPlaneBeside(corners, {.velocity_mps = ego.velocity_world_mps,
                                  .radius_m = options_.radius_factor * ego.radius_m,
                                  .max_speed_mps = ego.preferred_speed_mps,
                                  .horizon_s = options_.obstacle_horizon_s});
    if (half_plane) {
      half_planes_.push_back(*half_plane);
    }
  }

  // Nearer to the outline, or along it, but no deeper.
  void addWayOut(const Vector2d& way_out) {
    const double depth_m = way_out.norm();
    if (depth_m > 0.0) {
      half_planes_.push_back({way_out / depth_m, 0.0});
    }
  }

  bool isFree(const Vector2d& velocity) const {
    return std::all_of(half_planes_.begin(), half_planes_.end(),
                       [&](const HalfPlane& each) { return each.margin(velocity) >= 0.0; });
  }

  Decision toDecision(const core::EgoAgent& ego, const Vector2d& velocity) const {
    Decision decision;
    decision.neighbours_used = static_cast<int>(neighbours_.size());
    const double speed = velocity.norm();
    if (speed < kStandingMps) {
      return decision;
    }
    decision.speed_mps = std::min(speed, ego.preferred_speed_mps);
    decision.heading_change_rad =
        core::wrapToPi(std::atan2(velocity.y(), velocity.x()) - ego.heading_world_rad);
    if (std::abs(decision.heading_change_rad) > options_.max_heading_change_rad) {
      decision.speed_mps = 0.0;
      decision.heading_change_rad =
          std::copysign(options_.max_heading_change_rad, decision.heading_change_rad);
    }
    return decision;
  }

  config::Orca options_;
  Eigen::Rotation2Dd turn_right_;
  std::vector<Neighbour> neighbours_;
  std::vector<Vector2d> corners_;       // of one obstacle, from the ego
  std::vector<HalfPlane> half_planes_;  // of obstacles, then of neighbours
  LinearProgram program_;
};

}  // namespace

std::unique_ptr<Policy> makeOrca(const PolicyOptions& options) {
  return std::make_unique<Orca>(options.orca);
}

}  // namespace roundabout::planner
