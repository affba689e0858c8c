#include "planner/shield/look_ahead.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

constexpr int kDirections = 24;
constexpr std::array kSpeedShares{1.0, 0.5};
constexpr std::size_t kCandidates = kDirections * kSpeedShares.size() + 1;

}  // namespace

// In nobody's way nearer than the gap, unless it was as near already.
bool LookAhead::clear(const Ego& ego, const Scene& scene, const Vector2d& velocity_mps) {
  const SentCommand command{velocity_mps, 0.0, parameters_.look_ahead_s};
  predict(ego.motion, ego.bounds, Pace::kAssumed, Arrival::kAll, &command, path_);
  const auto steps = static_cast<std::size_t>(parameters_.look_ahead_s / Path::kStep_s);
  const Points points = path_.points().first(std::min(steps + 1, path_.points().size()));
  for (const Disc& disc : scene.discs()) {
    const double apart_m = disc.apart_m - parameters_.margin_m + parameters_.look_ahead_gap_m;
    const double now_m = disc.relative_m.norm();
    if (now_m - apart_m >
        parameters_.look_ahead_s * (ego.max_speed_mps + disc.velocity_mps.norm())) {
      continue;
    }
    const double least_m = std::min(apart_m, now_m - 1e-3);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double time_s = static_cast<double>(k) * Path::kStep_s;
      const Vector2d other = scene.position() + disc.relative_m + time_s * disc.velocity_mps;
      if ((points[k] - other).squaredNorm() < least_m * least_m) {
        return false;
      }
    }
  }
  return true;
}

std::optional<Vector2d> LookAhead::instead(const Ego& ego, const Scene& scene,
                                           const BrakeConstraints& constraints,
                                           const Vector2d& wanted_mps) {
  if (clear(ego, scene, wanted_mps)) {
    return std::nullopt;
  }
  std::array<std::pair<double, Vector2d>, kCandidates> candidates;
  std::size_t count = 0;
  const auto add = [&](const Vector2d& velocity) {
    candidates[count++] = {(velocity - wanted_mps).squaredNorm(), velocity};
  };
  const double speed = std::max(wanted_mps.norm(), 1e-3);
  const double first = std::atan2(wanted_mps.y(), wanted_mps.x());
  add(Vector2d::Zero());
  for (const double share : kSpeedShares) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle = first - 2.0 * std::numbers::pi * i / kDirections;
      add(share * speed * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first - 1e-12; });
  for (const auto& [distance, velocity] : candidates) {
    if (clear(ego, scene, velocity) && constraints.keeps(velocity)) {
      return velocity;
    }
  }
  return std::nullopt;
}

}  // namespace roundabout::planner::shield
