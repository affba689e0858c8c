#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/shield/motion.h"

// What all predictions of paths have in common.
namespace roundabout::planner::shield {

// Of the integration: a step of a path is a whole number of these.
inline constexpr int kSubsteps = 2;
inline constexpr double kStep_s = Path::kStep_s / kSubsteps;
// Slower, and without a command to come: it stands, but for what the lags still carry it.
inline constexpr double kStanding_mps = 0.02;
inline constexpr double kNever_s = std::numeric_limits<double>::infinity();

// The share of the way to its input that a first-order lag goes within a step.
inline double lagShare(double lag_s) {
  return lag_s > 0.0 ? 1.0 - std::exp(-kStep_s / lag_s) : 1.0;
}

// What a vehicle is told to do, by commands that take effect after the delay.
class Schedule {
 public:
  /// Stays in force until some time.
  struct Order {
    Eigen::Vector2d velocity_mps;
    double until_s;
  };

  Schedule() = default;
  Schedule(const Forecast& forecast, double delay_s)
      : commands_(forecast.motion->commands), next_(forecast.next), delay_s_(delay_s) {
    if (forecast.arrival == Arrival::kLastIsLost && !commands_.empty()) {
      commands_ = commands_.first(commands_.size() - 1);
    }
  }

  /// time_s: from now on; negative: in the past.
  Order at(double time_s) const {
    double until_s = kNever_s;
    if (next_ != nullptr) {
      const double start_s = delay_s_ - next_->age_s;
      if (time_s >= start_s) {
        return inForce(*next_, time_s, until_s);
      }
      until_s = start_s;
    }
    for (std::size_t i = commands_.size(); i-- > 0;) {
      const double start_s = delay_s_ - commands_[i].age_s;
      if (time_s >= start_s) {
        return inForce(commands_[i], time_s, until_s);
      }
      until_s = std::min(until_s, start_s);
    }
    return {commands_.empty() ? Eigen::Vector2d(Eigen::Vector2d::Zero())
                              : commands_.front().velocity_world_mps,
            until_s};
  }

  /// From then on there is no order any more.
  double end() const {
    if (next_ != nullptr) {
      return endOf(*next_);
    }
    return commands_.empty() ? -kNever_s : endOf(commands_.back());
  }

 private:
  double endOf(const SentCommand& command) const {
    return std::max(command.valid_for_s, delay_s_ + Path::kStep_s) - command.age_s;
  }
  Order inForce(const SentCommand& command, double time_s, double until_s) const {
    const double end_s = endOf(command);
    return time_s < end_s ? Order{command.velocity_world_mps, std::min(until_s, end_s)}
                          : Order{Eigen::Vector2d::Zero(), until_s};
  }

  std::span<const SentCommand> commands_;
  const SentCommand* next_ = nullptr;
  double delay_s_ = 0.0;
};

}  // namespace roundabout::planner::shield
