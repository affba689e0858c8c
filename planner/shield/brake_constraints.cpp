#include "planner/shield/brake_constraints.h"

#include <algorithm>
#include <cmath>

#include "common/core/polygon.h"
#include "planner/shield/lanes.h"

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
  forecastOwn();
  near_.clear();
  for (const Neighbour& neighbour : neighbours) {
    if (mayMeet(neighbour)) {
      near_.push_back(&neighbour);
      forecast(neighbour);
    }
  }
  if (paths_.size() < forecasts_.size()) {
    paths_.resize(forecasts_.size());
  }
  predict(forecasts_, paths_);
  std::size_t next = takeOwnPaths();
  for (const Neighbour* neighbour : near_) {
    next = addNeighbour(*neighbour, next);
  }
  first_static_ = half_planes_.size();
  for (const Wall& wall : statics.walls) {
    addWall(wall);
  }
  for (const core::Polygon& obstacle : statics.obstacles) {
    addObstacle(obstacle, 0.0);
  }
  for (const core::Polygon& piece : statics.mapped) {
    addObstacle(piece, statics.mapped_slack_m);
  }
}

void BrakeConstraints::forecastOwn() {
  if (responses_.empty() || !same(ego_->bounds, reach_bounds_)) {
    reach_bounds_ = ego_->bounds;
    responses_.clear();
    for (const Pace pace : pacesOf(reach_bounds_)) {
      responses_.push_back({pace, {}, reachOf(reach_bounds_, pace, parameters_.hold_s)});
    }
  }
  reach_m_ = farthestReach(ego_->motion, ego_->bounds, ego_->max_speed_mps, parameters_.hold_s);
  brake_ = {Vector2d::Zero(), 0.0, parameters_.hold_s};
  forecasts_.clear();
  for (const Response& response : responses_) {
    const Forecast own{&ego_->motion, &ego_->bounds, response.pace, Arrival::kAll, nullptr};
    forecasts_.push_back(own);
    forecasts_.back().next = &brake_;
    if (!ego_->motion.commands.empty()) {
      forecasts_.push_back(own);
      forecasts_.push_back(own);
      forecasts_.back().arrival = Arrival::kLastIsLost;
    }
  }
}

void BrakeConstraints::forecast(const Neighbour& neighbour) {
  for (const Pace pace : pacesOf(neighbour.bounds)) {
    forecasts_.push_back({&neighbour.motion, &neighbour.bounds, pace, Arrival::kAll, nullptr});
    if (!neighbour.motion.commands.empty()) {
      forecasts_.push_back(
          {&neighbour.motion, &neighbour.bounds, pace, Arrival::kLastIsLost, nullptr});
    }
  }
}

// Returns how many there are.
std::size_t BrakeConstraints::takeOwnPaths() {
  const std::size_t each = ego_->motion.commands.empty() ? 1 : 3;
  const std::size_t count = each * responses_.size();
  own_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    own_.append(paths_[i].points());
    if (i % each == 0) {
      PointSet& braking = responses_[i / each].braking;
      braking.clear();
      braking.append(paths_[i].points());
      braking.extendTo(Path::kMost);
    }
  }
  return count;
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

// Its paths begin with `first`; returns where those of the next do.
std::size_t BrakeConstraints::addNeighbour(const Neighbour& neighbour, std::size_t first) {
  others_.clear();
  double apart_m = ego_->radius_m + neighbour.radius_m + parameters_.margin_m;
  const bool trusted = neighbour.shielded;
  const std::size_t end =
      first + pacesOf(neighbour.bounds).size() * (neighbour.motion.commands.empty() ? 1 : 2);
  for (std::size_t i = first; i < end; ++i) {
    others_.append(paths_[i].points());
  }
  if (!trusted) {
    const Motion& motion = neighbour.motion;
    const double ahead_s = motion.age_s + parameters_.unshielded_prediction_s;
    const Vector2d there = motion.position_world_m + ahead_s * motion.velocity_world_mps +
                           0.5 * ahead_s * ahead_s * motion.drives.front().acceleration_mps2;
    others_.append(std::span(&there, 1));
    apart_m += parameters_.unshielded_margin_m;
  }
  const double before_m = smallest_gap_m_;
  addBeside(others_, apart_m, trusted && !neighbour.parked ? 0.5 : 1.0);
  smallest_gap_m_ = std::min(before_m, smallest_gap_m_);
  return end;
}

void BrakeConstraints::addBeside(const PointSet& points, double apart_m, double share) {
  const ConvexGap gap = gapBetween(own_, points);
  smallest_gap_m_ = std::min(smallest_gap_m_, gap.distance_m - apart_m + parameters_.margin_m);
  add(gap.normal, gap.distance_m - apart_m, share);
}

void BrakeConstraints::addWall(const Wall& wall) {
  const double usable_m =
      wall.offset_m - ego_->radius_m - parameters_.margin_m - own_.extentAlong(wall.normal);
  if (usable_m <= reach_m_) {
    add(wall.normal, usable_m, 1.0);
  }
}

void BrakeConstraints::addObstacle(const core::Polygon& obstacle, double slack_m) {
  const double apart_m = ego_->radius_m + parameters_.margin_m - slack_m;
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
  Line line{normal, own_.extentAlong(normal) + share * usable_m, {}};
  double fastest_mps = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < responses_.size(); ++i) {
    fastest_mps = std::min(fastest_mps, fastest(responses_[i], line));
    line.allowed_m[i] =
        std::max(line.limit_m, responses_[i].braking.extentAlong(normal)) + kRounding_m;
  }
  fastest_mps = std::max(fastest_mps, -kRetreatShare * ego_->max_speed_mps);
  lines_.push_back(line);
  half_planes_.push_back({-normal, -fastest_mps});
}

double BrakeConstraints::fastest(const Response& response, const Line& line) const {
  static_assert(Path::kMost % kLanes == 0);
  Lanes fastest_mps = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < response.per_speed_s.size(); i += kLanes) {
    const Lanes per_speed_s = loadLanes(&response.per_speed_s[i]);
    const Lanes left_m = line.limit_m - (line.normal.x() * loadLanes(&response.braking.xs()[i]) +
                                         line.normal.y() * loadLanes(&response.braking.ys()[i]));
    where(per_speed_s > kNoReach_s, fastest_mps) = min(fastest_mps, left_m / per_speed_s);
  }
  return hmin(fastest_mps);
}

bool BrakeConstraints::rollsOut(const Vector2d& velocity_mps) const {
  if (ego_->bounds.lag_s == 0.0 && !ego_->bounds.turns()) {
    return true;  // the linear rule is exact
  }
  const SentCommand command{velocity_mps, 0.0, parameters_.hold_s};
  std::array<Forecast, kPaces> forecasts;
  for (std::size_t i = 0; i < responses_.size(); ++i) {
    forecasts[i] = {&ego_->motion, &ego_->bounds, responses_[i].pace, Arrival::kAll, &command};
  }
  predict(std::span(forecasts).first(responses_.size()), rolled_out_);
  for (std::size_t i = 0; i < responses_.size(); ++i) {
    rolled_points_.clear();
    rolled_points_.append(rolled_out_[i].points());
    if (!std::all_of(lines_.begin(), lines_.end(), [&](const Line& line) {
          return rolled_points_.extentAlong(line.normal) <= line.allowed_m[i];
        })) {
      return false;
    }
  }
  return true;
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
