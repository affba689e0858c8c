#include "sim/world.h"

#include <utility>

#include "common/config/obstacles.h"
#include "sim/dynamics/table.h"
#include "sim/start_places.h"

namespace roundabout::sim {

namespace {

std::vector<double> bodyRadii(const config::Experiment& experiment) {
  std::vector<double> radii;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    radii.push_back(vehicle.body_radius_m);
  }
  return radii;
}

}  // namespace

World::World(const config::Experiment& experiment, core::Utime start_utime)
    : now_(start_utime),
      step_us_(core::toUtime(experiment.sim.step_s)),
      contacts_(bodyRadii(experiment), config::outlinesOf(experiment.obstacles)) {
  const std::vector<config::Start> starts = startPlaces(experiment);
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const config::Vehicle& vehicle = experiment.vehicles[i];
    auto dynamics = makeDynamics(vehicle, experiment.sim, starts[i], experiment.file);
    const VehicleAutopilot::Limits limits{experiment.sim.command_hold_s,
                                          experiment.sim.command_land_s, dynamics->commandDelayS(),
                                          vehicle.top_speed_mps, config::flies(vehicle)};
    bodies_.push_back(dynamics->body());
    vehicles_.push_back(
        {std::move(dynamics), VehicleAutopilot(limits), pushesOn(vehicle.name, experiment.sim)});
  }
}

std::vector<World::TimedPush> World::pushesOn(const std::string& name,
                                              const config::Sim& sim) const {
  std::vector<TimedPush> pushes;
  for (const config::Push& push : sim.pushes) {
    if (push.vehicle == name) {
      const core::Utime begin = now_ + core::toUtime(push.at_s);
      pushes.push_back({begin, begin + core::toUtime(push.duration_s), push.acceleration_mps2});
    }
  }
  return pushes;
}

const char* World::accept(std::size_t vehicle, const core::Command& command) {
  return vehicles_[vehicle].autopilot.accept(command, now_);
}

void World::step() {
  const double step_s = core::toSeconds(step_us_);
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    Vehicle& vehicle = vehicles_[i];
    Eigen::Vector2d push = Eigen::Vector2d::Zero();
    for (const TimedPush& timed : vehicle.pushes) {
      if (now_ >= timed.begin && now_ < timed.end) {
        push += timed.acceleration_mps2;
      }
    }
    vehicle.dynamics->step(vehicle.autopilot.update(now_, bodies_[i]), push, step_s);
    bodies_[i] = vehicle.dynamics->body();
  }
  now_ += step_us_;
  contacts_.update(now_, step_us_, bodies_);
}

}  // namespace roundabout::sim
