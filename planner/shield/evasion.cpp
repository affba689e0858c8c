#include "planner/shield/evasion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/shield/scene.h"

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

constexpr std::array kSpeedShares{1.0, 0.5};
// Metres of clearance that a change by the top speed is worth: from the wanted command, and from
// the last.
constexpr double kDetour_m = 0.02;
constexpr double kChange_m = 0.02;
// Whoever is shielded gives way too: between it and one that does not, it is the lesser evil.
constexpr double kShieldedWeight = 0.5;

Vector2d limited(const Vector2d& velocity_mps, double fastest_mps) {
  const double speed = velocity_mps.norm();
  return speed > fastest_mps ? Vector2d(velocity_mps * (fastest_mps / speed)) : velocity_mps;
}

}  // namespace

bool Evasion::mayMeet(const Ego& ego, const Neighbour& other) const {
  const double apart_m =
      ego.radius_m + other.radius_m + parameters_.margin_m + parameters_.unshielded_margin_m +
      parameters_.unshielded_horizon_s * (ego.max_speed_mps + other.max_speed_mps);
  return overlapInHeight(ego, other, parameters_) &&
         (other.motion.position_world_m - ego.motion.position_world_m).squaredNorm() <=
             apart_m * apart_m;
}

// At its velocity, and while the acceleration that is seen dies away.
void Evasion::addCourse(const Ego& ego, const Neighbour& other) {
  if (count_ == courses_.size()) {
    courses_.emplace_back();
  }
  Course& course = courses_[count_++];
  const bool trusted = other.shielded || other.parked;
  course.apart_m = ego.radius_m + other.radius_m + parameters_.margin_m +
                   (trusted ? 0.0 : parameters_.unshielded_margin_m);
  course.weight = trusted ? kShieldedWeight : 1.0;
  const Motion& motion = other.motion;
  const Vector2d velocity = other.parked ? Vector2d(Vector2d::Zero()) : motion.velocity_world_mps;
  const double lag_s = parameters_.unshielded_prediction_s;
  const Vector2d gained =
      trusted ? Vector2d(Vector2d::Zero())
              : Vector2d(limited(velocity + lag_s * motion.drives.front().acceleration_mps2,
                                 other.max_speed_mps) -
                         velocity);
  course.points_world_m.clear();
  const auto steps = static_cast<std::size_t>(parameters_.unshielded_horizon_s / Path::kStep_s);
  for (std::size_t k = 0; k <= steps; ++k) {
    const double time_s = motion.age_s + static_cast<double>(k) * Path::kStep_s;
    course.points_world_m.push_back(motion.position_world_m + time_s * velocity +
                                    (time_s - lag_s * (1.0 - std::exp(-time_s / lag_s))) * gained);
  }
}

void Evasion::predictCourses(const Ego& ego, std::span<const Neighbour> neighbours, bool shielded) {
  for (const Neighbour& each : neighbours) {
    if ((each.shielded || each.parked) == shielded && mayMeet(ego, each)) {
      addCourse(ego, each);
    }
  }
}

/// Weighted, of the worst; negative: too near.
double Evasion::clearanceOf(const Ego& ego, const Vector2d& velocity_mps) {
  const SentCommand command{velocity_mps, 0.0, parameters_.unshielded_horizon_s};
  predict({&ego.motion, &ego.bounds, Pace::kAssumed, Arrival::kAll, &command}, path_);
  const Points own = path_.points();
  double clearance_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count_; ++i) {
    const Course& course = courses_[i];
    double nearest_m2 = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < course.points_world_m.size(); ++k) {
      const Vector2d apart = own[std::min(k, own.size() - 1)] - course.points_world_m[k];
      nearest_m2 = std::min(nearest_m2, apart.squaredNorm());
    }
    clearance_m = std::min(clearance_m, course.weight * (std::sqrt(nearest_m2) - course.apart_m));
  }
  return clearance_m;
}

std::optional<Vector2d> Evasion::instead(const Ego& ego, std::span<const Neighbour> neighbours,
                                         const BrakeConstraints& constraints,
                                         const Vector2d& wanted_mps) {
  count_ = 0;
  predictCourses(ego, neighbours, false);
  if (count_ == 0 || clearanceOf(ego, wanted_mps) >= 0.0) {
    last_mps_.reset();
    return std::nullopt;
  }
  predictCourses(ego, neighbours, true);
  const auto scoreOf = [&](const Vector2d& velocity) {
    const double change = last_mps_ ? (velocity - *last_mps_).norm() : 0.0;
    return std::min(clearanceOf(ego, velocity), 0.0) -
           (kDetour_m * (velocity - wanted_mps).norm() + kChange_m * change) /
               std::max(ego.max_speed_mps, 1e-3);
  };
  std::optional<Vector2d> best;
  double highest = -std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vector2d& velocity) {
    const double score = scoreOf(velocity);
    if (score > highest + 1e-9 && constraints.keeps(velocity)) {
      highest = score;
      best = velocity;
    }
  };
  consider(wanted_mps);
  consider(Vector2d::Zero());
  const auto fan = fanFrom(wanted_mps);
  for (const double share : kSpeedShares) {
    // To the right first: of equally good ones it stays.
    for (const Vector2d& direction : fan) {
      consider(share * ego.max_speed_mps * direction);
    }
  }
  last_mps_ = best;
  return best == wanted_mps ? std::nullopt : best;
}

}  // namespace roundabout::planner::shield
