#include "planner/shield/motion.h"

#include <algorithm>
#include <cmath>

#include "common/core/angles.h"
#include "planner/shield/lanes.h"
#include "planner/shield/prediction.h"
#include "planner/shield/two_lags.h"

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

Vector2d limited(const Vector2d& vector, double longest) {
  const double length_squared = vector.squaredNorm();
  return length_squared > longest * longest
             ? Vector2d(vector * (longest / std::sqrt(length_squared)))
             : vector;
}

/// Follows velocity commands step by step, as bounds say; of what has no inner lag, or turns.
class Follower {
 public:
  Follower(const Motion& motion, const MotionBounds& bounds)
      : bounds_(bounds),
        share_(lagShare(bounds.lag_s)),
        position_m_(motion.position_world_m),
        velocity_mps_(motion.velocity_world_mps),
        heading_rad_(motion.heading_world_rad) {}

  /// A part, at most the whole, of a step.
  void step(const Vector2d& command_mps, double part = 1.0) {
    part_ = part;
    if (bounds_.turns()) {
      drive(command_mps);
    } else if (bounds_.lag_s > 0.0) {
      track(command_mps);
    } else {
      velocity_mps_ = command_mps;
    }
    position_m_ += velocity_mps_ * (part_ * kStep_s);
  }

  const Vector2d& position() const { return position_m_; }

  /// With no command to come.
  bool stands() const { return velocity_mps_.squaredNorm() < kStanding_mps * kStanding_mps; }
  Vector2d restingPlace() const {
    return position_m_ + velocity_mps_ * (bounds_.lag_s + bounds_.inner_lag_s);
  }

 private:
  void track(const Vector2d& command_mps) {
    velocity_mps_ += limited(part_ * share_ * (command_mps - velocity_mps_),
                             bounds_.max_acceleration_mps2 * part_ * kStep_s);
  }

  void drive(const Vector2d& command_mps) {
    const double speed = command_mps.norm();
    double along = 0.0;
    if (speed > 1e-9) {
      const double course = std::atan2(command_mps.y(), command_mps.x());
      const double most = bounds_.max_turn_rate_radps * part_ * kStep_s;
      heading_rad_ += std::clamp(core::wrapToPi(course - heading_rad_), -most, most);
      along = speed * std::max(0.0, std::cos(course - heading_rad_));
    }
    const Vector2d wanted = along * Vector2d(std::cos(heading_rad_), std::sin(heading_rad_));
    velocity_mps_ += limited(part_ * share_ * (wanted - velocity_mps_),
                             bounds_.max_acceleration_mps2 * part_ * kStep_s);
  }

  const MotionBounds& bounds_;
  double part_ = 1.0;
  double share_;
  Vector2d position_m_;
  Vector2d velocity_mps_;
  double heading_rad_;
};

void predictAlone(const Forecast& forecast, Path& path) {
  path.clear();
  const Motion& motion = *forecast.motion;
  const MotionBounds bounds = forecast.bounds->at(forecast.pace);
  Follower follower(motion, bounds);
  const Schedule schedule(forecast, bounds.delay_s);
  double time_s = -motion.age_s;
  while (time_s < -1e-9) {
    const double step_s = std::min(kStep_s, -time_s);
    follower.step(schedule.at(time_s + 0.5 * step_s).velocity_mps, step_s / kStep_s);
    time_s += step_s;
  }
  time_s = 0.0;
  path.add(follower.position());
  const double end_s = schedule.end();
  while (path.points().size() < Path::kMost - 1 &&
         !(follower.stands() && time_s + 0.5 * kStep_s >= end_s)) {
    for (int i = 0; i < kSubsteps; ++i) {
      follower.step(schedule.at(time_s + 0.5 * kStep_s).velocity_mps);
      time_s += kStep_s;
    }
    path.add(follower.position());
  }
  path.add(follower.restingPlace());
}

}  // namespace

MotionBounds MotionBounds::at(Pace pace) const {
  MotionBounds bounds = *this;
  if (pace == Pace::kSlowest) {
    bounds.delay_s *= reserve;
    bounds.lag_s *= reserve;
    bounds.inner_lag_s *= reserve;
  }
  return bounds;
}

Vector2d wantedAcceleration(const Vector2d& error_mps, const MotionBounds& bounds) {
  return limited(error_mps / bounds.lag_s, bounds.max_acceleration_mps2);
}

void follow(const Vector2d& wanted_mps2, const MotionBounds& bounds, double share, double step_s,
            Drive& drive) {
  drive.wanted_mps2 += limited(wanted_mps2 - drive.wanted_mps2, bounds.max_jerk_mps3 * step_s);
  drive.acceleration_mps2 += share * (drive.wanted_mps2 - drive.acceleration_mps2);
}

void predict(const Forecast& forecast, Path& path) {
  predict(std::span(&forecast, 1), std::span(&path, 1));
}

void predict(std::span<const Forecast> forecasts, std::span<Path> paths) {
  for (std::size_t first = 0; first < forecasts.size();) {
    if (!hasTwoLags(*forecasts[first].bounds)) {
      predictAlone(forecasts[first], paths[first]);
      ++first;
      continue;
    }
    std::size_t count = 1;
    while (count < kLanes && first + count < forecasts.size() &&
           hasTwoLags(*forecasts[first + count].bounds)) {
      ++count;
    }
    predictTwoLags(forecasts.subspan(first, count), paths.subspan(first, count));
    first += count;
  }
}

std::array<double, Path::kMost> reachOf(const MotionBounds& bounds, Pace pace, double hold_s) {
  std::array<double, Path::kMost> reach{};
  MotionBounds free = bounds;
  free.max_acceleration_mps2 = std::numeric_limits<double>::infinity();
  free.max_jerk_mps3 = std::numeric_limits<double>::infinity();
  free.max_turn_rate_radps = std::numeric_limits<double>::infinity();
  const Motion motion;
  const SentCommand unit{Vector2d(1.0, 0.0), 0.0, hold_s};
  Path path;
  predict({&motion, &free, pace, Arrival::kAll, &unit}, path);
  for (std::size_t i = 0; i < reach.size(); ++i) {
    reach[i] = path.points()[std::min(i, path.points().size() - 1)].x();
  }
  return reach;
}

}  // namespace roundabout::planner::shield
