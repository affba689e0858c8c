#include "planner/shield/look_ahead.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

constexpr std::array kSpeedShares{1.0, 0.5};
constexpr std::size_t kCandidates = kFanDirections * kSpeedShares.size() + 1;

}  // namespace

// Into paths_, of which there are as many at least.
void LookAhead::rollOut(const Ego& ego, std::span<const Vector2d> velocities_mps) {
  std::array<SentCommand, std::tuple_size_v<decltype(paths_)>> commands;
  std::array<Forecast, commands.size()> forecasts;
  for (std::size_t i = 0; i < velocities_mps.size(); ++i) {
    commands[i] = {velocities_mps[i], 0.0, parameters_.look_ahead_s};
    forecasts[i] = {&ego.motion, &ego.bounds, Pace::kAssumed, Arrival::kAll, &commands[i]};
  }
  predict(std::span(forecasts).first(velocities_mps.size()), paths_);
}

// In nobody's way nearer than the gap, unless it was as near already.
bool LookAhead::isClear(const Path& path, const Ego& ego, const Scene& scene) const {
  const auto steps = static_cast<std::size_t>(parameters_.look_ahead_s / Path::kStep_s);
  const Points points = path.points().first(std::min(steps + 1, path.points().size()));
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
  rollOut(ego, std::span(&wanted_mps, 1));
  if (isClear(paths_.front(), ego, scene)) {
    return std::nullopt;
  }
  std::array<Vector2d, kCandidates> candidates;
  std::size_t count = 0;
  candidates[count++] = Vector2d::Zero();
  const double speed = std::max(wanted_mps.norm(), 1e-3);
  const auto fan = fanFrom(wanted_mps);
  for (const double share : kSpeedShares) {
    for (const Vector2d& direction : fan) {
      candidates[count++] = share * speed * direction;
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
    return (a - wanted_mps).squaredNorm() < (b - wanted_mps).squaredNorm() - 1e-12;
  });
  for (std::size_t first = 0; first < candidates.size(); first += paths_.size()) {
    const auto some =
        std::span(candidates).subspan(first, std::min(paths_.size(), candidates.size() - first));
    rollOut(ego, some);
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (isClear(paths_[i], ego, scene) && constraints.keeps(some[i])) {
        return some[i];
      }
    }
  }
  return std::nullopt;
}

}  // namespace roundabout::planner::shield
