#include "planner/policies/cadrl/candidates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/angles.h"

namespace roundabout::planner {

namespace {

constexpr std::array kToGoalFractions = {1.0, 0.8, 0.6, 0.4, 0.2};
constexpr std::array kTurnedFractions = {1.0, 0.75, 0.5, 0.25};
constexpr int kTurns = 10;
constexpr double kLargestTurnRad = std::numbers::pi / 3.0;
static_assert(2 + kToGoalFractions.size() + kTurnedFractions.size() * kTurns == kCandidates);

}  // namespace

std::array<Candidate, kCandidates> candidatesOf(const core::EgoAgent& ego) {
  std::array<Candidate, kCandidates> candidates;
  std::size_t count = 0;
  const auto add = [&](double speed_mps, double heading_rad) {
    const double heading = core::wrapToPi(heading_rad);
    candidates[count++] = {
        speed_mps, heading, {speed_mps * std::cos(heading), speed_mps * std::sin(heading)}};
  };
  const double preferred_mps = ego.preferred_speed_mps;
  add(std::min(ego.velocity_world_mps.norm(), preferred_mps), ego.heading_world_rad);
  const Eigen::Vector2d to_goal = ego.goal_world_m - ego.position_world_m;
  for (const double fraction : kToGoalFractions) {
    add(fraction * preferred_mps, std::atan2(to_goal.y(), to_goal.x()));
  }
  add(0.0, 0.0);
  for (const double fraction : kTurnedFractions) {
    for (int i = 0; i < kTurns; ++i) {
      const double turn_rad = kLargestTurnRad * (2.0 * i / (kTurns - 1) - 1.0);
      add(fraction * preferred_mps, ego.heading_world_rad + turn_rad);
    }
  }
  return candidates;
}

}  // namespace roundabout::planner
