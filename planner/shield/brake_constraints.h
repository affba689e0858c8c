#pragma once

#include <array>
#include <limits>
#include <vector>

#include "planner/linear_program/half_plane.h"
#include "planner/linear_program/linear_program.h"
#include "planner/shield/convex_gap.h"
#include "planner/shield/shield.h"

namespace roundabout::planner::shield {

/// They are not so far apart vertically that they pass each other.
bool overlapInHeight(const Ego& ego, const Neighbour& other, const ShieldParameters& parameters);

/// The hard layer: what a command must keep so that the brake path of the ego meets nobody else's,
/// no wall and no obstacle. docs/shield.md, "The invariant".
class BrakeConstraints {
 public:
  explicit BrakeConstraints(const ShieldParameters& parameters) : parameters_(parameters) {}

  /// For what is known now. Both must outlive the next calls.
  void build(const Ego& ego, std::span<const Neighbour> neighbours, const Statics& statics);

  /// Whether a command keeps them all, by the linear rule and by a roll-out with the bounds of the
  /// vehicle.
  bool keeps(const Eigen::Vector2d& velocity_mps) const;

  /// A command that keeps them all and is near the wanted one; braking, if nothing else does.
  /// keeps_heading: slower in the same direction, if that is possible.
  Eigen::Vector2d nearest(const Eigen::Vector2d& wanted_mps, bool keeps_heading);

  /// Of those that `velocity_mps` breaks, the worst is of a wall or an obstacle.
  bool worstIsStatic(const Eigen::Vector2d& velocity_mps) const;

  double smallestGapM() const { return smallest_gap_m_; }

 private:
  static constexpr std::size_t kPaces = 2;

  /// The line that the ego's path must not cross: normal . p <= limit.
  struct Line {
    Eigen::Vector2d normal;
    double limit_m;
    std::array<double, kPaces> allowed_m;  // by pace: what braking breaks, commands may break too
  };

  /// Of the ego, at one pace.
  struct Response {
    Pace pace = Pace::kAssumed;
    PointSet braking;                               // from now on; at its end once more and again
    std::array<double, Path::kMost> per_speed_s{};  // of reachOf
  };

  void forecastOwn();
  void forecast(const Neighbour& neighbour);
  std::size_t takeOwnPaths();
  std::size_t addNeighbour(const Neighbour& neighbour, std::size_t first);
  void addObstacle(const core::Polygon& obstacle, double slack_m);
  void addWall(const Wall& wall);
  void addBeside(const PointSet& points, double apart_m, double share);
  void add(const Eigen::Vector2d& normal, double usable_m, double share);
  bool mayMeet(const Neighbour& neighbour) const;
  double fastest(const Response& response, const Line& line) const;
  bool rollsOut(const Eigen::Vector2d& velocity_mps) const;
  Eigen::Vector2d slowed(const Eigen::Vector2d& wanted_mps) const;

  const ShieldParameters& parameters_;
  const Ego* ego_ = nullptr;
  std::vector<Response> responses_;
  MotionBounds reach_bounds_;  // what responses_ are for
  PointSet own_;               // all places of all own paths
  PointSet others_;            // the same of a neighbour
  std::vector<const Neighbour*> near_;
  SentCommand brake_;                            // zero velocity
  std::vector<Forecast> forecasts_;              // the ego's, then those of all who are near
  std::vector<Path> paths_;                      // the same
  mutable std::array<Path, kPaces> rolled_out_;  // for one call
  mutable PointSet rolled_points_;               // the same
  double reach_m_ = 0.0;                         // of the ego's centre until it stands
  std::vector<Line> lines_;
  std::vector<HalfPlane> half_planes_;
  std::size_t first_static_ = 0;
  double smallest_gap_m_ = std::numeric_limits<double>::infinity();
  LinearProgram program_;
};

}  // namespace roundabout::planner::shield
