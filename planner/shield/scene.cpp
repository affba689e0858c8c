#include "planner/shield/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace roundabout::planner::shield {

using Eigen::Vector2d;

// The way round those that are parked may graze them, where gaps are narrow: the hard layer sees to
// it that it does no more.
constexpr double kGraze_m = 0.05;

double timeToDisc(const Vector2d& relative_m, const Vector2d& relative_mps, double radius_m) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double approach = relative_m.dot(relative_mps);
  if (approach <= 0.0) {
    return kNever;
  }
  const double outside = relative_m.squaredNorm() - radius_m * radius_m;
  if (outside <= 0.0) {
    return 0.0;
  }
  const double speed_squared = relative_mps.squaredNorm();
  const double root = approach * approach - speed_squared * outside;
  return root < 0.0 ? kNever : outside / (approach + std::sqrt(root));
}

std::array<Vector2d, kFanDirections> fanFrom(const Vector2d& direction) {
  std::array<Vector2d, kFanDirections> fan;
  const double first = std::atan2(direction.y(), direction.x());
  for (std::size_t i = 0; i < fan.size(); ++i) {
    const double angle = first - 2.0 * std::numbers::pi * static_cast<double>(i) / kFanDirections;
    fan[i] = {std::cos(angle), std::sin(angle)};
  }
  return fan;
}

void Scene::build(const Ego& ego, std::span<const Neighbour> neighbours,
                  const ShieldParameters& parameters) {
  const auto nowOf = [](const Motion& motion) {
    return Vector2d(motion.position_world_m + motion.age_s * motion.velocity_world_mps);
  };
  position_m_ = nowOf(ego.motion);
  velocity_mps_ = ego.motion.velocity_world_mps;
  discs_.clear();
  for (const Neighbour& each : neighbours) {
    if (each.motion.lowest_m - ego.motion.highest_m > parameters.height_separation_m ||
        ego.motion.lowest_m - each.motion.highest_m > parameters.height_separation_m) {
      continue;
    }
    const double margin_m =
        parameters.margin_m + (each.shielded ? 0.0 : parameters.unshielded_margin_m);
    discs_.push_back({nowOf(each.motion) - position_m_,
                      each.parked ? Vector2d(Vector2d::Zero()) : each.motion.velocity_world_mps,
                      ego.radius_m + each.radius_m + margin_m, each.parked, each.gives_way,
                      each.id});
  }
  std::sort(discs_.begin(), discs_.end(), [](const Disc& a, const Disc& b) {
    return std::tuple(a.relative_m.squaredNorm(), a.id) <
           std::tuple(b.relative_m.squaredNorm(), b.id);
  });
}

double Scene::timeToCollision(const Vector2d& velocity_mps, double horizon_s,
                              double enough_s) const {
  double earliest_s = horizon_s;
  for (const Disc& disc : discs_) {
    const Vector2d relative =
        disc.parked ? velocity_mps
                    : Vector2d(2.0 * velocity_mps - velocity_mps_ - disc.velocity_mps);
    const double apart_m = disc.parked ? disc.apart_m - kGraze_m : disc.apart_m;
    earliest_s = std::min(earliest_s, timeToDisc(disc.relative_m, relative, apart_m));
    if (earliest_s < enough_s) {
      break;
    }
  }
  return earliest_s;
}

double Scene::timeToActive(const Vector2d& velocity_mps, double horizon_s) const {
  double earliest_s = horizon_s;
  for (const Disc& disc : discs_) {
    if (!disc.parked) {
      const Vector2d relative = 2.0 * velocity_mps - velocity_mps_ - disc.velocity_mps;
      earliest_s = std::min(earliest_s, timeToDisc(disc.relative_m, relative, disc.apart_m));
    }
  }
  return earliest_s;
}

}  // namespace roundabout::planner::shield
