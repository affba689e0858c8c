#include "planner/policies/cadrl/joint_state.h"

#include <algorithm>
#include <cmath>

#include "common/core/angles.h"

namespace roundabout::planner {

namespace {

using Eigen::Vector2d;

// What the network was trained on ends here.
constexpr double kMostToGoalM = 30.0;
constexpr double kMostOffsetM = 8.0;
constexpr double kLeastGapM = -3.0;
constexpr double kMostGapM = 10.0;
// Nearer than this the direction to the goal is the ego's heading.
constexpr double kAtGoalM = 1e-5;
// Square of the speed below which an agent stands.
constexpr double kStandingM2ps2 = 1e-5;

constexpr float kMoves = 1.0F;
constexpr float kStands = 2.0F;
constexpr float kNobody = 0.0F;

float single(double value) { return static_cast<float>(value); }

}  // namespace

JointState jointState(const core::EgoAgent& ego, std::span<const core::OtherAgent> others) {
  const Vector2d to_goal = ego.goal_world_m - ego.position_world_m;
  const double distance_m = to_goal.norm();
  const double goal_angle_rad =
      distance_m > kAtGoalM ? std::atan2(to_goal.y(), to_goal.x()) : ego.heading_world_rad;
  const Vector2d parallel = distance_m > kAtGoalM
                                ? Vector2d(to_goal / distance_m)
                                : Vector2d(std::cos(goal_angle_rad), std::sin(goal_angle_rad));
  const Vector2d orthogonal(-parallel.y(), parallel.x());

  JointState state;
  const double heading_rad = core::wrapToPi(ego.heading_world_rad - goal_angle_rad);
  const double speed_mps = ego.velocity_world_mps.norm();
  state.own = {single(std::min(distance_m, kMostToGoalM)),
               single(ego.preferred_speed_mps),
               single(speed_mps),
               single(heading_rad),
               single(speed_mps * std::cos(heading_rad)),
               single(speed_mps * std::sin(heading_rad)),
               single(ego.radius_m)};
  for (std::size_t k = 0; k < state.others.size(); ++k) {
    if (k >= others.size()) {
      state.others[k] = state.others[0];
      state.others[k].back() = kNobody;
      continue;
    }
    const core::OtherAgent& other = others[k];
    const Vector2d offset = other.position_world_m - ego.position_world_m;
    const Vector2d velocity(other.velocity_world_mps.dot(parallel),
                            other.velocity_world_mps.dot(orthogonal));
    const double combined_m = ego.radius_m + other.radius_m;
    state.others[k] = {single(velocity.x()),
                       single(velocity.y()),
                       single(std::clamp(offset.dot(parallel), -kMostOffsetM, kMostOffsetM)),
                       single(std::clamp(offset.dot(orthogonal), -kMostOffsetM, kMostOffsetM)),
                       single(other.radius_m),
                       single(combined_m),
                       single(std::clamp(offset.norm() - combined_m, kLeastGapM, kMostGapM)),
                       velocity.squaredNorm() < kStandingM2ps2 ? kStands : kMoves};
  }
  return state;
}

}  // namespace roundabout::planner
