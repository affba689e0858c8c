#include "planner/observation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "common/core/angles.h"

namespace roundabout::planner {

namespace {

float single(double value) { return static_cast<float>(value); }

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

/// Slower than this two agents do not approach each other. m/s.
constexpr double kStanding_mps = 1e-5;

/// Time until two discs touch that keep their velocities; 0 if they overlap, infinite if they never
/// do. s.
double timeToCollision(const Eigen::Vector2d& offset_m, const Eigen::Vector2d& velocity_mps,
                       double combined_radius_m) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // |offset + velocity t| = combined radius: speed^2 t^2 - 2 approach t + outside = 0.
  const double outside = offset_m.squaredNorm() - combined_radius_m * combined_radius_m;
  if (outside < 0.0) {
    return 0.0;
  }
  const double approach = -offset_m.dot(velocity_mps);
  const double discriminant = approach * approach - velocity_mps.squaredNorm() * outside;
  if (approach <= 0.0 || discriminant < 0.0 || velocity_mps.norm() < kStanding_mps) {
    return kNever;
  }
  return outside / (approach + std::sqrt(discriminant));
}

}  // namespace

ObservationEncoder::ObservationEncoder(int max_others, OthersOrder order)
    : max_others_(static_cast<std::size_t>(max_others)), order_(order) {
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

  observation_.ego = {single(distance_m),
                      single(core::wrapToPi(ego.heading_world_rad - goal_angle_rad)),
                      single(ego.preferred_speed_mps), single(ego.radius_m)};

  collect(ego, others, parallel);
  sortMostUrgentFirst();
  candidates_.resize(std::min(candidates_.size(), max_others_));
  if (order_ != OthersOrder::kClosestFirst) {
    sortMostUrgentLast();
  }
  observation_.others.clear();
  for (const Candidate& candidate : candidates_) {
    observation_.others.push_back(candidate.features);
  }
  return observation_;
}

void ObservationEncoder::collect(const core::EgoAgent& ego,
                                 std::span<const core::OtherAgent> others,
                                 const Eigen::Vector2d& parallel) {
  const Eigen::Vector2d orthogonal(-parallel.y(), parallel.x());
  candidates_.clear();
  for (const core::OtherAgent& other : others) {
    const Eigen::Vector2d offset = other.position_world_m - ego.position_world_m;
    const double combined_radius_m = ego.radius_m + other.radius_m;
    const double gap_m = offset.norm() - ego.radius_m - other.radius_m;
    const double orthogonal_m = offset.dot(orthogonal);
    const double collision_s =
        order_ == OthersOrder::kTimeToCollision
            ? timeToCollision(offset, other.velocity_world_mps - ego.velocity_world_mps,
                              combined_radius_m)
            : 0.0;
    candidates_.push_back({collision_s,
                           roundedHundredths(gap_m),
                           orthogonal_m,
                           candidates_.size(),
                           {single(offset.dot(parallel)), single(orthogonal_m),
                            single(other.velocity_world_mps.dot(parallel)),
                            single(other.velocity_world_mps.dot(orthogonal)),
                            single(other.radius_m), single(combined_radius_m), single(gap_m)}});
  }
}

void ObservationEncoder::sortMostUrgentFirst() {
  std::sort(candidates_.begin(), candidates_.end(),
            [](const Candidate& left, const Candidate& right) {
              return std::tie(left.collision_s, left.gap_cm, left.orthogonal_m, left.index) <
                     std::tie(right.collision_s, right.gap_cm, right.orthogonal_m, right.index);
            });
}

// Not the reverse: of equally urgent ones the one of smaller orthogonal position comes first here
// as well, as in the published environment.
void ObservationEncoder::sortMostUrgentLast() {
  std::sort(candidates_.begin(), candidates_.end(),
            [](const Candidate& left, const Candidate& right) {
              return std::tie(right.collision_s, right.gap_cm, left.orthogonal_m, left.index) <
                     std::tie(left.collision_s, left.gap_cm, right.orthogonal_m, right.index);
            });
}

}  // namespace roundabout::planner
