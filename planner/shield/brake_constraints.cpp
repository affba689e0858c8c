#include "planner/shield/brake_constraints.h"

#include <algorithm>
#include <cmath>

#include "common/core/polygon.h"

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

// Who has come too near shall move away, no faster than this share of its top speed.
constexpr double kRetreatShare = 0.3;
// A command that has carried the vehicle less than this changes nothing yet. s
constexpr double kNoReach_s = 1e-6;
constexpr int kBisections = 7;
// Of the roll-out: rounding. m
constexpr double kRounding_m = 1e-9;

bool same(const MotionBounds& a, const MotionBounds& b) {
  return a.delay_s == b.delay_s && a.lag_s == b.lag_s && a.inner_lag_s == b.inner_lag_s &&
         a.max_acceleration_mps2 == b.max_acceleration_mps2 &&
         a.max_turn_rate_radps == b.max_turn_rate_radps && a.reserve == b.reserve &&
         a.max_jerk_mps3 == b.max_jerk_mps3;
}

// The slowest pace is another one.
std::span<const Pace> pacesOf(const MotionBounds& bounds) {
  static constexpr std::array kPaces{Pace::kAssumed, Pace::kSlowest};
  return std::span(kPaces).first(bounds.reserve > 1.0 ? 2 : 1);
}

// How far a vehicle gets at most until it stands.
double farthestReach(const Motion& motion, const MotionBounds& assumed, double max_speed_mps,
                     double hold_s) {
  const MotionBounds bounds = assumed.at(Pace::kSlowest);
  const double speed = std::max(motion.velocity_world_mps.norm(), max_speed_mps);
  const double braking_s =
      bounds.lag_s + bounds.inner_lag_s +
      (std::isfinite(bounds.max_acceleration_mps2) ? 0.5 * speed / bounds.max_acceleration_mps2
                                                   : 0.0);
  return speed * (bounds.delay_s + hold_s + braking_s + motion.age_s);
}

}  // namespace

bool overlapInHeight(const Ego& ego, const Neighbour& other, const ShieldParameters& parameters) {
  return other.motion.lowest_m - ego.motion.highest_m <= parameters.height_separation_m &&
         ego.motion.lowest_m - other.motion.highest_m <= parameters.height_separation_m;
}

void BrakeConstraints::build(const Ego& ego, std::span<const Neighbour> neighbours,
                             const Statics& statics) {
  ego_ = &ego;
  lines_.clear();
  half_planes_.clear();
  smallest_gap_m_ = std::numeric_limits<double>::infinity();
  predictOwn();
  for (const Neighbour& neighbour : neighbours) {
    if (mayMeet(neighbour)) {
      addNeighbour(neighbour);
    }
  }
  first_static_ = half_planes_.size();
  for (const Wall& wall : statics.walls) {
    addWall(wall);
  }
  for (const core::Polygon& obstacle : statics.obstacles) {
    addObstacle(obstacle);
  }
  for (const core::Polygon& piece : statics.mapped) {
    addObstacle(piece);
  }
}

void BrakeConstraints::predictOwn() {
  if (responses_.empty() || !same(ego_->bounds, reach_bounds_)) {
    reach_bounds_ = ego_->bounds;
    responses_.clear();
    for (const Pace pace : pacesOf(reach_bounds_)) {
      responses_.push_back({pace, {}, reachOf(reach_bounds_, pace, parameters_.hold_s)});
    }
  }
  reach_m_ = farthestReach(ego_->motion, ego_->bounds, ego_->max_speed_mps, parameters_.hold_s);
  const SentCommand brake{Vector2d::Zero(), 0.0, parameters_.hold_s};
  own_.clear();
  for (Response& response : responses_) {
    const auto addPath = [&](Arrival arrival, const SentCommand* next, Path& path) {
      predict(ego_->motion, ego_->bounds, response.pace, arrival, next, path);
      own_.insert(own_.end(), path.points().begin(), path.points().end());
    };
    addPath(Arrival::kAll, &brake, response.braking);
    if (!ego_->motion.commands.empty()) {
      addPath(Arrival::kAll, nullptr, path_);
      addPath(Arrival::kLastIsLost, nullptr, path_);
    }
  }
}

bool BrakeConstraints::mayMeet(const Neighbour& neighbour) const {
  const Motion& own = ego_->motion;
  const Motion& other = neighbour.motion;
  if (!overlapInHeight(*ego_, neighbour, parameters_)) {
    return false;
  }
  const double reach_m =
      reach_m_ + farthestReach(other, neighbour.bounds, neighbour.max_speed_mps,
                               std::max(parameters_.hold_s, parameters_.unshielded_prediction_s));
  const double apart_m = ego_->radius_m + neighbour.radius_m + parameters_.margin_m +
                         parameters_.unshielded_margin_m + reach_m;
  return (other.position_world_m - own.position_world_m).squaredNorm() <= apart_m * apart_m;
}

void BrakeConstraints::addNeighbour(const Neighbour& neighbour) {
  others_.clear();
  double apart_m = ego_->radius_m + neighbour.radius_m + parameters_.margin_m;
  const bool trusted = neighbour.shielded;
  for (const Pace pace : pacesOf(neighbour.bounds)) {
    for (const Arrival arrival : {Arrival::kAll, Arrival::kLastIsLost}) {
      predict(neighbour.motion, neighbour.bounds, pace, arrival, nullptr, path_);
      others_.insert(others_.end(), path_.points().begin(), path_.points().end());
      if (neighbour.motion.commands.empty()) {
        break;
      }
    }
  }
  if (!trusted) {
    const Motion& motion = neighbour.motion;
    const double ahead_s = motion.age_s + parameters_.unshielded_prediction_s;
    others_.push_back(motion.position_world_m + ahead_s * motion.velocity_world_mps +
                      0.5 * ahead_s * ahead_s * motion.drives.front().acceleration_mps2);
    apart_m += parameters_.unshielded_margin_m;
  }
  const double before_m = smallest_gap_m_;
  addBeside(others_, apart_m, trusted && !neighbour.parked ? 0.5 : 1.0);
  smallest_gap_m_ = std::min(before_m, smallest_gap_m_);
}

void BrakeConstraints::addBeside(Points points, double apart_m, double share) {
  const ConvexGap gap = gapBetween(own_, points);
  smallest_gap_m_ = std::min(smallest_gap_m_, gap.distance_m - apart_m + parameters_.margin_m);
  add(gap.normal, gap.distance_m - apart_m, share);
}

void BrakeConstraints::addWall(const Wall& wall) {
  const double usable_m =
      wall.offset_m - ego_->radius_m - parameters_.margin_m - extentAlong(own_, wall.normal);
  if (usable_m <= reach_m_) {
    add(wall.normal, usable_m, 1.0);
  }
}

void BrakeConstraints::addObstacle(const core::Polygon& obstacle) {
  const double apart_m = ego_->radius_m + parameters_.margin_m;
  const bool convex = core::isConvex(obstacle);
  const std::size_t parts = convex ? 1 : obstacle.size();
  for (std::size_t i = 0; i < parts; ++i) {
    const std::array<Vector2d, 2> side{obstacle[i], obstacle[(i + 1) % obstacle.size()]};
    const Points points = convex ? Points(obstacle) : Points(side);
    const ConvexGap gap = gapBetween(own_, points);
    if (gap.distance_m - apart_m <= reach_m_) {
      add(gap.normal, gap.distance_m - apart_m, 1.0);
    }
  }
}

// The own path may come nearer by a share of the usable gap. A command u that is held adds
// per_speed(t) u to it: linear in u.
void BrakeConstraints::add(const Vector2d& normal, double usable_m, double share) {
  const Line line{normal, extentAlong(own_, normal) + share * usable_m};
  double fastest_mps = std::numeric_limits<double>::infinity();
  for (const Response& response : responses_) {
    fastest_mps = std::min(fastest_mps, fastest(response, line));
  }
  fastest_mps = std::max(fastest_mps, -kRetreatShare * ego_->max_speed_mps);
  lines_.push_back(line);
  half_planes_.push_back({-normal, -fastest_mps});
}

double BrakeConstraints::fastest(const Response& response, const Line& line) const {
  const Points braking = response.braking.points();
  const auto& per_speed_s = response.per_speed_s;
  double fastest_mps = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < per_speed_s.size(); ++i) {
    if (per_speed_s[i] > kNoReach_s) {
      const double left_m =
          line.limit_m - line.normal.dot(braking[std::min(i, braking.size() - 1)]);
      fastest_mps = std::min(fastest_mps, left_m / per_speed_s[i]);
      if (i + 1 >= braking.size() && per_speed_s[i] == per_speed_s.back()) {
        break;  // nothing moves any more
      }
    }
  }
  return fastest_mps;
}

bool BrakeConstraints::rollsOut(const Vector2d& velocity_mps) const {
  if (ego_->bounds.lag_s == 0.0 && !ego_->bounds.turns()) {
    return true;  // the linear rule is exact
  }
  const SentCommand command{velocity_mps, 0.0, parameters_.hold_s};
  return std::all_of(responses_.begin(), responses_.end(), [&](const Response& response) {
    predict(ego_->motion, ego_->bounds, response.pace, Arrival::kAll, &command, path_);
    return std::all_of(lines_.begin(), lines_.end(), [&](const Line& line) {
      // What braking breaks already, a command must not make worse.
      const double limit_m =
          std::max(line.limit_m, extentAlong(response.braking.points(), line.normal)) + kRounding_m;
      return extentAlong(path_.points(), line.normal) <= limit_m;
    });
  });
}

bool BrakeConstraints::keeps(const Vector2d& velocity_mps) const {
  return std::all_of(half_planes_.begin(), half_planes_.end(),
                     [&](const HalfPlane& each) { return each.margin(velocity_mps) >= -1e-9; }) &&
         rollsOut(velocity_mps);
}

bool BrakeConstraints::worstIsStatic(const Vector2d& velocity_mps) const {
  double worst = 0.0;
  std::size_t which = 0;
  for (std::size_t i = 0; i < half_planes_.size(); ++i) {
    const double margin = half_planes_[i].margin(velocity_mps);
    if (margin < worst) {
      worst = margin;
      which = i;
    }
  }
  return worst < 0.0 && which >= first_static_;
}

// The same direction, as fast as may be.
Vector2d BrakeConstraints::slowed(const Vector2d& wanted_mps) const {
  double share = 1.0;
  for (const HalfPlane& each : half_planes_) {
    const double along = each.normal.dot(wanted_mps);
    if (each.margin(wanted_mps) < 0.0 && along < 0.0) {
      share = std::min(share, std::max(0.0, each.offset_mps / along));
    }
  }
  return share * wanted_mps;
}

Vector2d BrakeConstraints::nearest(const Vector2d& wanted_mps, bool keeps_heading) {
  if (keeps(wanted_mps)) {
    return wanted_mps;
  }
  Vector2d chosen = slowed(wanted_mps);
  if (!keeps_heading || !keeps(chosen)) {
    chosen = program_.solve(half_planes_, wanted_mps, ego_->max_speed_mps).velocity_mps;
  }
  if (rollsOut(chosen)) {
    return chosen;
  }
  double good = 0.0;
  double bad = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (good + bad);
    (rollsOut(middle * chosen) ? good : bad) = middle;
  }
  return good * chosen;
}

}  // namespace roundabout::planner::shield
