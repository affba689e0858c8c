#include "planner/shield/step_aside.h"

#include <algorithm>

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

// More than the radii and the margin: the asker takes the way only if it is clear.
constexpr double kRoom_m = 0.15;

}  // namespace

std::optional<Vector2d> placeAside(const Ego& ego, const Scene& scene,
                                   std::span<const Neighbour> neighbours,
                                   const ShieldParameters& parameters) {
  std::optional<Vector2d> aside;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Neighbour& asker : neighbours) {
    if (!asker.asks_for_way || !asker.goal_world_m.allFinite()) {
      continue;
    }
    const Vector2d way = asker.goal_world_m - asker.motion.position_world_m;
    const double length_m = way.norm();
    if (length_m < 1e-6) {
      continue;
    }
    const Vector2d along = way / length_m;
    const Vector2d home = ego.goal_world_m - asker.motion.position_world_m;
    const double reached_m = along.dot(home);
    const double apart_m = ego.radius_m + asker.radius_m + parameters.margin_m + kRoom_m;
    if (reached_m < -apart_m || reached_m > length_m + apart_m) {
      continue;
    }
    const Vector2d left(-along.y(), along.x());
    const double beside_m = left.dot(home);
    if (std::abs(beside_m) >= apart_m || home.norm() >= nearest_m) {
      continue;
    }
    nearest_m = home.norm();
    // From where it is by now: it stays on the side that it has chosen.
    const double now_m = left.dot(scene.position() - asker.motion.position_world_m);
    const double side = now_m >= 0.0 ? 1.0 : -1.0;
    aside = ego.goal_world_m + (side * apart_m - beside_m) * left;
  }
  return aside;
}

}  // namespace roundabout::planner::shield
