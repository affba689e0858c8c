#include "planner/shield/motion.h"

#include <algorithm>
#include <cmath>

#include "common/core/angles.h"

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

// Of the integration: a step of a path is a whole number of these.
constexpr int kSubsteps = 2;
constexpr double kStep_s = Path::kStep_s / kSubsteps;
// Slower, and without a command to come: it stands, but for what the lags still carry it.
constexpr double kStanding_mps = 0.02;

Vector2d limited(const Vector2d& vector, double longest) {
  const double length_squared = vector.squaredNorm();
  return length_squared > longest * longest
             ? Vector2d(vector * (longest / std::sqrt(length_squared)))
             : vector;
}

// The share of the way to its input that a first-order lag goes within a step.
double lagShare(double lag_s) { return lag_s > 0.0 ? 1.0 - std::exp(-kStep_s / lag_s) : 1.0; }

/// Follows velocity commands step by step, as bounds say.
class Follower {
 public:
  Follower(const Motion& motion, const MotionBounds& bounds, Pace pace)
      : bounds_(bounds),
        share_(lagShare(bounds.lag_s)),
        inner_share_(lagShare(bounds.inner_lag_s)),
        position_m_(motion.position_world_m),
        velocity_mps_(motion.velocity_world_mps),
        drive_(motion.drives[static_cast<std::size_t>(pace)]),
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
    if (bounds_.inner_lag_s > 0.0) {
      follow(wantedAcceleration(command_mps - velocity_mps_, bounds_), bounds_,
             part_ * inner_share_, part_ * kStep_s, drive_);
      velocity_mps_ += drive_.acceleration_mps2 * (part_ * kStep_s);
    } else {
      velocity_mps_ += limited(part_ * share_ * (command_mps - velocity_mps_),
                               bounds_.max_acceleration_mps2 * part_ * kStep_s);
    }
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
  double inner_share_;
  Vector2d position_m_;
  Vector2d velocity_mps_;
  Drive drive_;
  double heading_rad_;
};

// What a vehicle is told to do at a time, by commands that take effect after the delay.
class Schedule {
 public:
  Schedule(const Motion& motion, const MotionBounds& bounds, Arrival arrival,
           const SentCommand* next)
      : commands_(motion.commands), next_(next), delay_s_(bounds.delay_s) {
    if (arrival == Arrival::kLastIsLost && !commands_.empty()) {
      commands_ = commands_.first(commands_.size() - 1);
    }
  }

  /// time_s: from now on; negative: in the past.
  Vector2d at(double time_s) const {
    if (next_ != nullptr && time_s >= delay_s_ - next_->age_s) {
      return valueOf(*next_, time_s);
    }
    for (std::size_t i = commands_.size(); i-- > 0;) {
      if (time_s >= delay_s_ - commands_[i].age_s) {
        return valueOf(commands_[i], time_s);
      }
    }
    return commands_.empty() ? Vector2d(Vector2d::Zero()) : commands_.front().velocity_world_mps;
  }

  bool overAt(double time_s) const {
    const double end_s = next_ != nullptr
                             ? endOf(*next_)
                             : (commands_.empty() ? -std::numeric_limits<double>::infinity()
                                                  : endOf(commands_.back()));
    return time_s >= end_s;
  }

 private:
  double endOf(const SentCommand& command) const {
    return std::max(command.valid_for_s, delay_s_ + Path::kStep_s) - command.age_s;
  }
  Vector2d valueOf(const SentCommand& command, double time_s) const {
    return time_s < endOf(command) ? command.velocity_world_mps : Vector2d(Vector2d::Zero());
  }

  std::span<const SentCommand> commands_;
  const SentCommand* next_;
  double delay_s_;
};

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

void predict(const Motion& motion, const MotionBounds& assumed, Pace pace, Arrival arrival,
             const SentCommand* next, Path& path) {
  path.clear();
  const MotionBounds bounds = assumed.at(pace);
  Follower follower(motion, bounds, pace);
  const Schedule schedule(motion, bounds, arrival, next);
  double time_s = -motion.age_s;
  while (time_s < -1e-9) {
    const double step_s = std::min(kStep_s, -time_s);
    follower.step(schedule.at(time_s + 0.5 * step_s), step_s / kStep_s);
    time_s += step_s;
  }
  time_s = 0.0;
  path.add(follower.position());
  while (path.points().size() < Path::kMost - 1 &&
         !(follower.stands() && schedule.overAt(time_s + 0.5 * kStep_s))) {
    for (int i = 0; i < kSubsteps; ++i) {
      follower.step(schedule.at(time_s + 0.5 * kStep_s));
      time_s += kStep_s;
    }
    path.add(follower.position());
  }
  path.add(follower.restingPlace());
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
  predict(motion, free, pace, Arrival::kAll, &unit, path);
  for (std::size_t i = 0; i < reach.size(); ++i) {
    reach[i] = path.points()[std::min(i, path.points().size() - 1)].x();
  }
  return reach;
}

}  // namespace roundabout::planner::shield
