#include "planner/shield/breaker.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "common/core/polygon.h"

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

constexpr std::array kSpeedShares{1.0, 2.0 / 3.0, 1.0 / 3.0};
constexpr double kCollisionWeight = 0.5;  // against the deviation in shares of the preferred speed
constexpr double kLeastTime_s = 0.05;
constexpr double kEqualCost = 1e-9;

constexpr double kFirstStay_s = 1.5;
constexpr double kLongestStay_s = 12.0;
constexpr double kGain_m = 0.2;
constexpr double kFreeFor_s = 2.0;
constexpr double kMovingShare = 0.25;

constexpr double kLeanRate_radps = 1.2;
constexpr double kUprightRate_radps = 1.0;
constexpr double kFreeUprightRate_radps = 4.0;  // once nobody is in the straight way any more
constexpr double kMostLean_rad = 2.4;
constexpr double kSmallLean_rad = 0.2;

constexpr double kReplan_s = 0.45;
constexpr double kOtherSideGain_m = 0.3;
constexpr double kReached_m = 0.15;
constexpr double kAskAfter_s = 4.0;
// Where a vehicle shall slow down near its goal it is expected to go on at least at this share.
constexpr double kLeastExpectedShare = 0.15;
// The breaker, which turns at once, slows down nearer to it, and less.
constexpr double kSlowDownShare = 0.6;
constexpr double kLeastApproachShare = 0.3;

// Of the preferred speed, going down linearly within a distance of the goal; 0: nowhere.
double approachShare(double distance_m, double within_m, double least) {
  return within_m > 0.0 ? std::clamp(distance_m / within_m, least, 1.0) : 1.0;
}

}  // namespace

void collectHindrances(const Ego& ego, const Scene& scene, const Statics& statics,
                       std::vector<Hindrance>& hindrances) {
  hindrances.clear();
  for (const Disc& disc : scene.discs()) {
    if (disc.parked) {
      hindrances.push_back({{scene.position() + disc.relative_m}, disc.apart_m});
    }
  }
  for (const core::Polygon& obstacle : statics.obstacles) {
    if (core::isConvex(obstacle)) {
      hindrances.push_back({obstacle, ego.radius_m});
      continue;
    }
    for (std::size_t i = 0; i < obstacle.size(); ++i) {
      hindrances.push_back({{obstacle[i], obstacle[(i + 1) % obstacle.size()]}, ego.radius_m});
    }
  }
}

void Breaker::reset() {
  last_s_.reset();
  active_ = false;
  entries_ = 0;
  progress_ = 1.0;
  lean_rad_ = 0.0;
  way_.clear();
}

std::optional<Breaker::Plan> Breaker::update(const Ego& ego, const Scene& scene,
                                             const Statics& statics, double now_s) {
  const double distance_m = (ego.goal_world_m - scene.position()).norm();
  if (!last_s_) {
    last_distance_m_ = closest_m_ = distance_m;
  }
  step_s_ = last_s_ ? std::max(0.0, now_s - *last_s_) : 0.0;
  last_s_ = now_s;
  noteProgress(ego, scene);
  if (!active_) {
    if (progress_ >= parameters_.stalled_share) {
      return std::nullopt;
    }
    begin();
  }
  active_s_ += step_s_;
  since_plan_s_ += step_s_;
  if (since_plan_s_ >= kReplan_s) {
    replan(ego, scene, statics);
  }
  while (way_.size() > 1 && (way_.front() - scene.position()).norm() < kReached_m) {
    way_.erase(way_.begin());
  }
  const Vector2d to_next = (way_.empty() ? ego.goal_world_m : way_.front()) - scene.position();
  const Vector2d direction =
      to_next.norm() > 1e-9 ? Vector2d(to_next.normalized()) : Vector2d(Vector2d::Zero());
  lean(scene, direction, expected_mps_);
  const double time_s = scene.timeToCollision(expected_mps_ * direction, kFreeFor_s);
  free_s_ = time_s >= kFreeFor_s && has_way_ ? free_s_ + step_s_ : 0.0;
  if (mayEnd(ego, scene)) {
    active_ = false;
    progress_ = 1.0;
    return std::nullopt;
  }
  const double speed_mps =
      std::max(expected_mps_,
               ego.preferred_speed_mps *
                   approachShare(distance_m, kSlowDownShare * parameters_.slow_down_distance_m,
                                 kLeastApproachShare));
  const Vector2d desired = speed_mps * (Eigen::Rotation2Dd(-lean_rad_) * direction);
  const bool asks = parameters_.steps_aside && (!has_way_ || active_s_ > kAskAfter_s);
  return Plan{sample(scene, desired, ego.preferred_speed_mps), asks};
}

void Breaker::noteProgress(const Ego& ego, const Scene& scene) {
  const double distance_m = (ego.goal_world_m - scene.position()).norm();
  expected_mps_ = std::max(
      1e-3, ego.preferred_speed_mps *
                approachShare(distance_m, parameters_.slow_down_distance_m, kLeastExpectedShare));
  if (step_s_ > 0.0) {
    const double rate = (last_distance_m_ - distance_m) / step_s_ / expected_mps_;
    const double share = 1.0 - std::exp(-step_s_ / parameters_.progress_time_constant_s);
    progress_ += share * (rate - progress_);
  }
  last_distance_m_ = distance_m;
  closest_m_ = std::min(closest_m_, distance_m);
}

void Breaker::begin() {
  active_ = true;
  ++entries_;
  active_s_ = 0.0;
  free_s_ = 0.0;
  record_m_ = closest_m_;
  lean_rad_ = 0.0;
  way_.clear();
  since_plan_s_ = kReplan_s;
}

bool Breaker::mayEnd(const Ego& ego, const Scene& scene) const {
  // So near, a policy turns slowly: one that does not head for its goal would miss it.
  if (ego.goal_is_final && last_distance_m_ < parameters_.slow_down_distance_m) {
    return false;
  }
  const double stay_s =
      std::min(kLongestStay_s, kFirstStay_s * std::exp2(std::min(entries_ - 1, 8)));
  const bool gained = last_distance_m_ < record_m_ - kGain_m || free_s_ >= kFreeFor_s;
  const bool moves = scene.velocity().norm() >= kMovingShare * expected_mps_;
  return active_s_ >= stay_s && gained && moves && lean_rad_ < kSmallLean_rad &&
         ego.preferred_speed_mps > 0.0;
}

void Breaker::replan(const Ego& ego, const Scene& scene, const Statics& statics) {
  since_plan_s_ = 0.0;
  collectHindrances(ego, scene, statics, hindrances_);
  auto shortest = way_round_.find(scene.position(), ego.goal_world_m, hindrances_);
  has_way_ = shortest.has_value();
  if (!has_way_) {
    way_.clear();
    return;
  }
  bool keeps = !way_.empty() && lengthOf(scene.position(), way_) <
                                    lengthOf(scene.position(), *shortest) + kOtherSideGain_m;
  Vector2d last = scene.position();
  for (std::size_t i = 0; i < way_.size() && keeps; ++i) {
    keeps = WayRound::isFree(last, way_[i], hindrances_);
    last = way_[i];
  }
  // The same side may have a shorter way by now: only another side is not taken lightly.
  const bool same_side =
      keeps && way_.size() > 1 && shortest->size() > 1 &&
      (way_.front() - scene.position()).dot(shortest->front() - scene.position()) > 0.0;
  if (!keeps || same_side || shortest->size() < 2) {
    way_ = std::move(*shortest);
  }
}

// Everybody who is blocked leans to the same side, so that they go round each other.
void Breaker::lean(const Scene& scene, const Vector2d& direction, double preferred_mps) {
  const double horizon_s = parameters_.block_horizon_s;
  if (scene.timeToCollision(preferred_mps * direction, horizon_s) >= horizon_s) {
    lean_rad_ = std::max(0.0, lean_rad_ - kFreeUprightRate_radps * step_s_);
    return;
  }
  const Vector2d leaning = Eigen::Rotation2Dd(-lean_rad_) * direction;
  const bool slow = scene.velocity().dot(leaning) < 0.25 * preferred_mps;
  const bool blocked = scene.timeToActive(preferred_mps * leaning, horizon_s) < horizon_s;
  lean_rad_ = slow && blocked ? std::min(kMostLean_rad, lean_rad_ + kLeanRate_radps * step_s_)
                              : std::max(0.0, lean_rad_ - kUprightRate_radps * step_s_);
}

Vector2d Breaker::sample(const Scene& scene, const Vector2d& desired_mps,
                         double preferred_mps) const {
  const double horizon_s = parameters_.breaker_horizon_s;
  Vector2d best = Vector2d::Zero();
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vector2d& velocity) {
    const double deviation = (velocity - desired_mps).norm() / preferred_mps;
    if (deviation >= least - kEqualCost) {
      return;
    }
    // Nearer in time than this, it costs more than the best one.
    const double enough_s = 0.999 / ((least - deviation) / kCollisionWeight + 1.0 / horizon_s);
    const double time_s = std::max(
        kLeastTime_s,
        scene.timeToCollision(velocity, horizon_s, enough_s > kLeastTime_s ? enough_s : 0.0));
    const double cost = deviation + kCollisionWeight * (1.0 / time_s - 1.0 / horizon_s);
    if (cost < least - kEqualCost) {
      least = cost;
      best = velocity;
    }
  };
  consider(Vector2d::Zero());
  const double speed = std::max(desired_mps.norm(), 1e-3);
  const auto fan = fanFrom(desired_mps);
  for (const double share : kSpeedShares) {
    // To the right first: of equally good ones it stays.
    for (const Vector2d& direction : fan) {
      consider(share * speed * direction);
    }
  }
  return best;
}

}  // namespace roundabout::planner::shield
