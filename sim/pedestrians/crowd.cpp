#include "sim/pedestrians/crowd.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <spdlog/fmt/fmt.h>

#include "common/config/obstacles.h"
#include "common/core/angles.h"
#include "common/core/error.h"
#include "common/core/polygon.h"

namespace roundabout::sim {

namespace {

using Eigen::Vector2d;

constexpr int kDraws = 2000;
constexpr double kApartM = 0.8;  // centres, when they begin
constexpr double kArrivedM = 0.3;
constexpr double kShortestWayM = 2.0;  // to a new goal, where the area is so large

}  // namespace

Crowd::Crowd(const config::Experiment& experiment, std::span<const BodyState> starts,
             const SteeringFactory& make_steering, core::Utime first_utime)
    : settings_(experiment.pedestrians),
      file_(experiment.file),
      obstacles_(config::outlinesOf(config::standingInSim(experiment))),
      random_(experiment.seed, "pedestrians"),
      timer_(1.0 / SocialForce::kPeriodS),
      first_utime_(first_utime) {
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    vehicle_radii_m_.push_back(vehicle.body_radius_m);
  }
  place(starts, make_steering);
  if (!settings_.recording.file.empty()) {
    recorded_.emplace(settings_.recording, experiment.file);
  }
  collect(0.0, starts);
}

void Crowd::place(std::span<const BodyState> starts, const SteeringFactory& make_steering) {
  const auto standing = static_cast<int>(std::lround(settings_.standing_share * settings_.count));
  for (int i = 0; i < settings_.count; ++i) {
    const std::optional<Vector2d> place_m = freePlace(starts);
    if (!place_m) {
      throw core::StartupError(
          file_, "pedestrians.area",
          fmt::format("room for {} people {} m apart, {} m from where vehicles start",
                      settings_.count, kApartM, settings_.clear_of_vehicles_m),
          fmt::format("none for number {}", i + 1));
    }
    Walker& walker = walkers_.emplace_back();
    walker.person.id = i + 1;
    walker.person.position_m = *place_m;
    walker.person.heading_rad = random_.uniform(-std::numbers::pi, std::numbers::pi);
    walker.person.gait_rad = random_.uniform(0.0, 2.0 * std::numbers::pi);
    walker.steering = make_steering();
    const double deviation_mps = random_.normal(settings_.speed_deviation_mps);
    walker.preferred_speed_mps =
        settings_.preferred_speed_mps *
        std::clamp(1.0 + deviation_mps / settings_.preferred_speed_mps, 0.5, 1.5);
    walker.cooperation = random_.uniform(settings_.least_cooperation, 1.0);
    walker.stands = i < standing;
  }
  for (Walker& walker : walkers_) {
    chooseGoal(walker);
  }
}

std::optional<Vector2d> Crowd::freePlace(std::span<const BodyState> starts) {
  for (int draw = 0; draw < kDraws; ++draw) {
    const Vector2d place_m = place();
    const bool free = isClear(place_m) &&
                      std::all_of(walkers_.begin(), walkers_.end(),
                                  [&](const Walker& other) {
                                    return (other.person.position_m - place_m).norm() >= kApartM;
                                  }) &&
                      !besideAVehicle(place_m, starts);
    if (free) {
      return place_m;
    }
  }
  return std::nullopt;
}

bool Crowd::besideAVehicle(const Vector2d& place_m, std::span<const BodyState> bodies) const {
  return std::any_of(bodies.begin(), bodies.end(), [&](const BodyState& vehicle) {
    return (vehicle.position_world_m.head<2>() - place_m).norm() < settings_.clear_of_vehicles_m;
  });
}

Vector2d Crowd::place() {
  const config::Area& area = settings_.area;
  const double x = random_.uniform(area.min_m.x(), area.max_m.x());
  return {x, random_.uniform(area.min_m.y(), area.max_m.y())};
}

bool Crowd::isClear(const Vector2d& place_m) const {
  return std::all_of(obstacles_.begin(), obstacles_.end(), [&](const core::Polygon& obstacle) {
    return core::distanceTo(obstacle, place_m) > 2.0 * settings_.body_radius_m;
  });
}

void Crowd::chooseGoal(Walker& walker) {
  walker.goal_m = walker.person.position_m;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Vector2d goal_m = place();
    if (isClear(goal_m)) {
      walker.goal_m = goal_m;
      if ((goal_m - walker.person.position_m).norm() >= kShortestWayM) {
        return;
      }
    }
  }
}

void Crowd::step(core::Utime now, double step_s, std::span<const BodyState> bodies) {
  if (timer_.due(now)) {
    exchangeRoles();
    decide(bodies);
  }
  const double share = 1.0 - std::exp(-step_s / SocialForce::kReactionS);
  for (Walker& walker : walkers_) {
    walker.person.velocity_mps += share * (walker.wanted_mps - walker.person.velocity_mps);
    walker.person.position_m += step_s * walker.person.velocity_mps;
    walk(walker.person, step_s);
    if (!walker.stands && (walker.goal_m - walker.person.position_m).norm() < kArrivedM) {
      chooseGoal(walker);
    }
  }
  collect(core::toSeconds(now - first_utime_), bodies);
  for (std::size_t i = walkers_.size(); i < people_.size(); ++i) {
    walk(people_[i], step_s);
  }
}

void Crowd::exchangeRoles() {
  // One draw a call, whatever happens.
  const bool exchange = settings_.role_change_s > 0.0 &&
                        random_.chance(SocialForce::kPeriodS / settings_.role_change_s);
  std::vector<Walker*> standing;
  std::vector<Walker*> walking;
  for (Walker& walker : walkers_) {
    (walker.stands ? standing : walking).push_back(&walker);
  }
  if (!exchange || standing.empty() || walking.empty()) {
    return;
  }
  Walker& starts = *standing[random_.index(standing.size())];
  Walker& stops = *walking[random_.index(walking.size())];
  starts.stands = false;
  stops.stands = true;
  chooseGoal(starts);
}

void Crowd::decide(std::span<const BodyState> bodies) {
  for (Walker& walker : walkers_) {
    walker.wanted_mps.setZero();
    if (walker.stands) {
      continue;
    }
    others_.clear();
    for (const Pedestrian& other : people_) {
      if (other.id != walker.person.id) {
        others_.push_back(
            {other.position_m, other.velocity_mps, settings_.body_radius_m, other.id});
      }
    }
    std::size_t vehicles = 0;
    for (std::size_t i = 0; i < bodies.size() && walker.cooperation > 0.0; ++i, ++vehicles) {
      others_.push_back({bodies[i].position_world_m.head<2>(),
                         bodies[i].velocity_world_mps.head<2>(), vehicle_radii_m_[i],
                         -1 - static_cast<int>(i)});
    }
    core::EgoAgent ego;
    ego.position_world_m = walker.person.position_m;
    ego.velocity_world_mps = walker.person.velocity_mps;
    ego.heading_world_rad = walker.person.heading_rad;
    ego.goal_world_m = walker.goal_m;
    ego.preferred_speed_mps = walker.preferred_speed_mps;
    ego.radius_m = settings_.body_radius_m;
    walker.wanted_mps =
        walker.steering->velocity(ego, others_, vehicles, walker.cooperation, obstacles_);
  }
}

void Crowd::collect(double seconds, std::span<const BodyState> bodies) {
  // Heading and gait of a recorded person go on from the step before.
  std::vector<Pedestrian> before;
  if (people_.size() > walkers_.size()) {
    before.assign(people_.begin() + static_cast<std::ptrdiff_t>(walkers_.size()), people_.end());
  }
  people_.clear();
  for (const Walker& walker : walkers_) {
    people_.push_back(walker.person);
  }
  if (!recorded_) {
    return;
  }
  recorded_->at(seconds, recorded_now_);
  for (Pedestrian& person : recorded_now_) {
    person.id += kRecordedIds;
    const auto known = std::find_if(before.begin(), before.end(),
                                    [&](const Pedestrian& other) { return other.id == person.id; });
    if (known != before.end()) {
      person.heading_rad = known->heading_rad;
      person.gait_rad = known->gait_rad;
    } else if (besideAVehicle(person.position_m, bodies)) {
      continue;
    } else {
      person.heading_rad = std::atan2(person.velocity_mps.y(), person.velocity_mps.x());
    }
    people_.push_back(person);
  }
}

}  // namespace roundabout::sim
