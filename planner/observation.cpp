#include "planner/observation.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/core/angles.h"

namespace roundabout::planner {

namespace {

/// Nearer than this the direction to the goal is undefined.
constexpr double kAtGoal_m = 1e-8;

/// The value in hundredths, rounded as Python's round(value, 2) does: the exact value decides, and
/// an exact half goes to the even neighbour.
double roundedHundredths(double value) {
  const double product = 100.0 * value;
  const double below = std::floor(product);
  // Rounding of the product cannot cross a half, only land on it.
  if (product - below == 0.5) {
    const double rounding_error = std::fma(100.0, value, -product);
    if (rounding_error != 0.0) {
      return rounding_error > 0.0 ? below + 1.0 : below;
    }
  }
  return std::nearbyint(product);
}

}  // namespace

ObservationEncoder::ObservationEncoder(int max_others)
    : max_others_(static_cast<std::size_t>(max_others)) {
  observation_.others.reserve(max_others_);
}

const Observation& ObservationEncoder::encode(const core::EgoAgent& ego,
                                              std::span<const core::OtherAgent> others) {
  const Eigen::Vector2d to_goal = ego.goal_world_m - ego.position_world_m;
  const double distance_m = to_goal.norm();
  const bool at_goal = distance_m <= kAtGoal_m;
  const double goal_angle_rad =
      at_goal ? ego.heading_world_rad : std::atan2(to_goal.y(), to_goal.x());
  const Eigen::Vector2d parallel =
      at_goal ? Eigen::Vector2d(std::cos(goal_angle_rad), std::sin(goal_angle_rad))
              : Eigen::Vector2d(to_goal / distance_m);
  const Eigen::Vector2d orthogonal(-parallel.y(), parallel.x());

  const auto single = [](double value) { return static_cast<float>(value); };
  observation_.ego = {single(distance_m),
                      single(core::wrapToPi(ego.heading_world_rad - goal_angle_rad)),
                      single(ego.preferred_speed_mps), single(ego.radius_m)};

  candidates_.clear();
  for (const core::OtherAgent& other : others) {
    const Eigen::Vector2d offset = other.position_world_m - ego.position_world_m;
    const double gap_m = offset.norm() - ego.radius_m - other.radius_m;
    const double orthogonal_m = offset.dot(orthogonal);
    candidates_.push_back(
        {roundedHundredths(gap_m),
         orthogonal_m,
         candidates_.size(),
         {single(offset.dot(parallel)), single(orthogonal_m),
          single(other.velocity_world_mps.dot(parallel)),
          single(other.velocity_world_mps.dot(orthogonal)), single(other.radius_m),
          single(ego.radius_m + other.radius_m), single(gap_m)}});
  }
  std::sort(candidates_.begin(), candidates_.end(),
            [](const Candidate& left, const Candidate& right) {
              return std::tie(left.gap_cm, left.orthogonal_m, left.index) <
                     std::tie(right.gap_cm, right.orthogonal_m, right.index);
            });
  candidates_.resize(std::min(candidates_.size(), max_others_));
  std::sort(candidates_.begin(), candidates_.end(),
            [](const Candidate& left, const Candidate& right) {
              return std::tie(right.gap_cm, left.orthogonal_m, left.index) <
                     std::tie(left.gap_cm, right.orthogonal_m, right.index);
            });
  observation_.others.clear();
  for (const Candidate& candidate : candidates_) {
    observation_.others.push_back(candidate.features);
  }
  return observation_;
}

}  // namespace roundabout::planner
