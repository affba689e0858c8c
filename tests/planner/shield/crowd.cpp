#include "tests/planner/shield/crowd.h"

#include <algorithm>
#include <cmath>

#include "common/core/angles.h"
#include "common/core/polygon.h"

namespace roundabout::planner::shield {

namespace {

using Eigen::Vector2d;

constexpr double kStep_s = 0.005;

Vector2d limitedTo(const Vector2d& vector, double longest) {
  const double length = vector.norm();
  return length > longest ? Vector2d(vector * (longest / length)) : vector;
}

}  // namespace

Crowd::Crowd(const CrowdSettings& settings, const ShieldParameters& parameters, std::uint64_t seed)
    : settings_(settings), parameters_(parameters), random_(seed, "crowd") {
  vehicles_.resize(static_cast<std::size_t>(settings.vehicles));
  if (settings.room_half_side_m > 0.0) {
    for (const Vector2d& out : {Vector2d(1, 0), Vector2d(0, 1), Vector2d(-1, 0), Vector2d(0, -1)}) {
      walls_.push_back({out, settings.room_half_side_m});
    }
  }
  place();
}

void Crowd::place() {
  double half_side_m = settings_.half_side_m;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    Vehicle& each = vehicles_[i];
    each.radius_m = random_.uniform(0.2, 0.5);
    each.top_speed_mps = random_.uniform(0.5, 1.5);
    each.next_decision_s =
        time_s_ + (settings_.ideal ? 0.0 : random_.uniform(0.0, settings_.period_s));
    const auto somewhere = [&] {
      half_side_m *= settings_.room_half_side_m > 0.0 ? 1.0 : 1.005;
      return Vector2d(random_.uniform(-half_side_m, half_side_m),
                      random_.uniform(-half_side_m, half_side_m));
    };
    const auto isFree = [&](const Vector2d& place) {
      const bool off_obstacles =
          std::all_of(settings_.obstacles.begin(), settings_.obstacles.end(),
                      [&](const core::Polygon& polygon) {
                        return core::distanceTo(polygon, place) > each.radius_m + 0.1;
                      });
      return off_obstacles &&
             std::all_of(vehicles_.begin(), vehicles_.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const Vehicle& other) {
                           return (other.position_m - place).norm() >
                                  other.radius_m + each.radius_m + 0.1;
                         });
    };
    do {
      each.position_m = somewhere();
    } while (!isFree(each.position_m));
    each.goal_m = somewhere();
    each.shield = std::make_unique<Shield>(parameters_);
    each.observers.assign(vehicles_.size(), Observer(settings_.assumed));
  }
}

void Crowd::observe() {
  for (Vehicle& watcher : vehicles_) {
    for (std::size_t j = 0; j < vehicles_.size(); ++j) {
      const Vehicle& seen = vehicles_[j];
      const Vector2d noise(random_.normal(1.0), random_.normal(1.0));
      const Vector2d velocity_noise(random_.normal(1.0), random_.normal(1.0));
      if (!observed_ || !random_.chance(settings_.loss)) {
        watcher.observers[j].onState(
            time_s_, seen.position_m + settings_.position_noise_m * noise,
            seen.velocity_mps + settings_.velocity_noise_mps * velocity_noise, seen.heading_rad);
      }
    }
  }
  observed_ = true;
}

void Crowd::decide(std::size_t i, const Want& want) {
  Vehicle& self = vehicles_[i];
  const double now_s = time_s_ + settings_.state_age_s;
  const auto motionOf = [&](std::size_t j) {
    if (settings_.ideal) {
      Motion motion;
      motion.position_world_m = vehicles_[j].position_m;
      motion.velocity_world_mps = vehicles_[j].velocity_mps;
      return motion;
    }
    return self.observers[j].motion(now_s);
  };
  Ego ego;
  ego.motion = motionOf(i);
  ego.bounds = settings_.assumed;
  ego.radius_m = self.radius_m;
  ego.goal_world_m = self.goal_m;
  ego.preferred_speed_mps = self.top_speed_mps;
  ego.max_speed_mps = self.top_speed_mps;
  ego.id = static_cast<int>(i);
  std::vector<Neighbour> neighbours;
  for (std::size_t j = 0; j < vehicles_.size(); ++j) {
    if (j == i) {
      continue;
    }
    Neighbour& other = neighbours.emplace_back();
    other.motion = motionOf(j);
    other.bounds = settings_.assumed;
    other.radius_m = vehicles_[j].radius_m;
    other.max_speed_mps = vehicles_[j].top_speed_mps;
    other.id = static_cast<int>(j);
  }
  const Vector2d velocity =
      self.shield->decide(ego, neighbours, {walls_, settings_.obstacles}, want(*this, i), now_s)
          .velocity_world_mps;
  if (settings_.ideal || !random_.chance(settings_.loss)) {
    const double from_s = now_s + settings_.truth.delay_s;
    self.commands.push_back({from_s, now_s + parameters_.hold_s, velocity});
  }
  self.observers[i].onCommand(now_s, velocity, parameters_.hold_s);
  for (std::size_t j = 0; j < vehicles_.size(); ++j) {
    if (j != i && !random_.chance(settings_.loss)) {
      vehicles_[j].observers[i].onCommand(now_s, velocity, parameters_.hold_s);
    }
  }
}

// Along its heading, with a limit on the turn rate.
void Crowd::drive(Vehicle& each, const Vector2d& command, double step_s) const {
  const double speed = command.norm();
  const double left =
      speed > 0.0 ? core::wrapToPi(std::atan2(command.y(), command.x()) - each.heading_rad) : 0.0;
  const double most = settings_.truth.max_turn_rate_radps * step_s;
  each.heading_rad += std::clamp(left, -most, most);
  const Vector2d along(std::cos(each.heading_rad), std::sin(each.heading_rad));
  const Vector2d wanted = std::max(0.0, along.dot(command)) * along;
  each.velocity_mps += limitedTo((wanted - each.velocity_mps) * (step_s / settings_.truth.lag_s),
                                 settings_.truth.max_acceleration_mps2 * step_s);
}

void Crowd::move(double step_s) {
  for (Vehicle& each : vehicles_) {
    while (each.commands.size() > 1 && each.commands[1].from_s <= time_s_ + 1e-9) {
      each.commands.pop_front();
    }
    Vector2d command = Vector2d::Zero();
    if (!each.commands.empty() && each.commands.front().from_s <= time_s_ + 1e-9 &&
        time_s_ < each.commands.front().until_s - 1e-9) {
      command = each.commands.front().velocity_mps;
    }
    if (settings_.ideal) {
      each.velocity_mps = command;
    } else if (settings_.truth.turns()) {
      drive(each, command, step_s);
    } else {
      const Vector2d wanted = limitedTo((command - each.velocity_mps) / settings_.truth.lag_s,
                                        settings_.truth.max_acceleration_mps2);
      each.acceleration_mps2 +=
          (wanted - each.acceleration_mps2) * (step_s / settings_.truth.inner_lag_s);
      each.velocity_mps += each.acceleration_mps2 * step_s;
    }
    each.position_m += each.velocity_mps * step_s;
  }
}

void Crowd::noteGaps() {
  for (const Vehicle& each : vehicles_) {
    for (const Wall& wall : walls_) {
      closest_static_m_ = std::min(
          closest_static_m_, wall.offset_m - each.radius_m - wall.normal.dot(each.position_m));
    }
    for (const core::Polygon& polygon : settings_.obstacles) {
      closest_static_m_ =
          std::min(closest_static_m_, core::distanceTo(polygon, each.position_m) - each.radius_m);
    }
  }
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    for (std::size_t j = i + 1; j < vehicles_.size(); ++j) {
      closest_m_ = std::min(closest_m_, (vehicles_[i].position_m - vehicles_[j].position_m).norm() -
                                            vehicles_[i].radius_m - vehicles_[j].radius_m);
    }
  }
}

long Crowd::run(double duration_s, const Want& want) {
  long decisions = 0;
  const double end_s = time_s_ + duration_s;
  while (time_s_ < end_s) {
    if (settings_.ideal) {
      for (std::size_t i = 0; i < vehicles_.size(); ++i) {
        vehicles_[i].commands.clear();
      }
      for (std::size_t i = 0; i < vehicles_.size(); ++i, ++decisions) {
        decide(i, want);
      }
      for (Vehicle& each : vehicles_) {
        each.commands.front().from_s = time_s_;
        each.commands.front().until_s = time_s_ + settings_.period_s;
      }
      move(settings_.period_s);
      time_s_ += settings_.period_s;
      noteGaps();
      continue;
    }
    observe();
    for (std::size_t i = 0; i < vehicles_.size(); ++i) {
      if (vehicles_[i].next_decision_s <= time_s_) {
        vehicles_[i].next_decision_s += settings_.period_s;
        decide(i, want);
        ++decisions;
      }
    }
    move(kStep_s);
    time_s_ += kStep_s;
    noteGaps();
  }
  return decisions;
}

Vector2d attack(const Crowd& crowd, std::size_t i) {
  const Crowd::Vehicle& self = crowd.vehicles()[i];
  const Crowd::Vehicle* nearest = nullptr;
  double nearest_m = 1e9;
  for (const Crowd::Vehicle& other : crowd.vehicles()) {
    const double gap_m = (other.position_m - self.position_m).norm() - other.radius_m;
    if (&other != &self && gap_m < nearest_m) {
      nearest_m = gap_m;
      nearest = &other;
    }
  }
  return nearest == nullptr
             ? Vector2d(Vector2d::Zero())
             : Vector2d(self.top_speed_mps * (nearest->position_m - self.position_m).normalized());
}

}  // namespace roundabout::planner::shield
