#include "planner/shield/observer.h"

#include <algorithm>
#include <cmath>

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

// Commands older than this have no effect any more.
constexpr double kForgotten_s = 1.5;
constexpr std::size_t kMostCommands = 32;
// Of velocity differences, without known commands.
constexpr double kFilter_s = 0.15;
// With them: of the integration between two measurements, and what share of the velocity that it
// did not foresee was acceleration rather than noise.
constexpr double kStep_s = 0.01;
constexpr double kTrust = 0.5;

}  // namespace

Observer::Observer(const MotionBounds& bounds, bool knows_commands)
    : bounds_(bounds), knows_commands_(knows_commands) {
  issued_.reserve(kMostCommands);
  sent_.reserve(kMostCommands);
}

void Observer::reset() {
  seen_ = false;
  issued_.clear();
  motion_ = Motion();
}

void Observer::onState(double measured_s, const Vector2d& position_m, const Vector2d& velocity_mps,
                       double heading_rad) {
  if (seen_ && measured_s > measured_s_) {
    estimateAcceleration(measured_s - measured_s_, measured_s, velocity_mps);
  }
  seen_ = true;
  measured_s_ = measured_s;
  motion_.position_world_m = position_m;
  motion_.velocity_world_mps = velocity_mps;
  motion_.heading_world_rad = heading_rad;
}

void Observer::estimateAcceleration(double step_s, double measured_s,
                                    const Vector2d& velocity_mps) {
  if (!knows_commands_) {
    const Vector2d measured = (velocity_mps - motion_.velocity_world_mps) / step_s;
    for (Drive& drive : motion_.drives) {
      drive.acceleration_mps2 +=
          (1.0 - std::exp(-step_s / kFilter_s)) * (measured - drive.acceleration_mps2);
      drive.wanted_mps2 = drive.acceleration_mps2;
    }
  } else if (bounds_.inner_lag_s > 0.0 && bounds_.lag_s > 0.0) {
    estimateDrive(Pace::kAssumed, step_s, measured_s, velocity_mps);
    estimateDrive(Pace::kSlowest, step_s, measured_s, velocity_mps);
  }
}

// The acceleration follows what the vehicle wants of it, by its commands. What has come of it says
// by how much that is wrong.
void Observer::estimateDrive(Pace pace, double step_s, double measured_s,
                             const Vector2d& velocity_mps) {
  const MotionBounds bounds = bounds_.at(pace);
  Drive& drive = motion_.drives[static_cast<std::size_t>(pace)];
  Vector2d velocity = motion_.velocity_world_mps;
  const int steps = std::clamp(static_cast<int>(std::ceil(step_s / kStep_s - 1e-9)), 1, 100);
  const double part_s = step_s / steps;
  const double share = 1.0 - std::exp(-part_s / bounds.inner_lag_s);
  for (int k = 0; k < steps; ++k) {
    const Vector2d command = commandAt(measured_s - step_s + (k + 0.5) * part_s, bounds.delay_s);
    follow(wantedAcceleration(command - velocity, bounds), bounds, share, part_s, drive);
    velocity += part_s * drive.acceleration_mps2;
  }
  const double seen_share = std::min(1.0, step_s / bounds.inner_lag_s);
  drive.acceleration_mps2 += kTrust * seen_share * (velocity_mps - velocity) / step_s;
}

Vector2d Observer::commandAt(double time_s, double delay_s) const {
  for (std::size_t i = issued_.size(); i-- > 0;) {
    const double since_s = time_s - issued_[i].at_s;
    if (since_s >= delay_s) {
      return since_s < issued_[i].valid_for_s ? issued_[i].velocity_mps
                                              : Vector2d(Vector2d::Zero());
    }
  }
  return Vector2d::Zero();
}

void Observer::onCommand(double issued_s, const Vector2d& velocity_mps, double valid_for_s) {
  if (!issued_.empty() && issued_s <= issued_.back().at_s) {
    return;
  }
  std::erase_if(issued_, [&](const Issued& each) { return issued_s - each.at_s > kForgotten_s; });
  if (issued_.size() == kMostCommands) {
    issued_.erase(issued_.begin());
  }
  issued_.push_back({issued_s, velocity_mps, valid_for_s});
}

const Motion& Observer::motion(double now_s) {
  motion_.age_s = std::max(0.0, now_s - measured_s_);
  sent_.clear();
  for (const Issued& each : issued_) {
    if (now_s - each.at_s <= kForgotten_s) {
      sent_.push_back({each.velocity_mps, now_s - each.at_s, each.valid_for_s});
    }
  }
  motion_.commands = sent_;
  return motion_;
}

}  // namespace roundabout::planner::shield
