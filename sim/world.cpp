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

std::unique_ptr<Steering> bySocialForce() { return std::make_unique<SocialForce>(); }

}  // namespace

World::World(const config::Experiment& experiment, core::Utime start_utime,
             const SteeringFactory& make_steering)
    : now_(start_utime),
      step_us_(core::toUtime(experiment.sim.step_s)),
      vehicles_(vehiclesOf(experiment)),
      bodies_(bodiesOf(vehicles_)),
      wheels_(vehicles_.size()),
      contacts_(bodyRadii(experiment), config::outlinesOf(config::standingInSim(experiment))),
      crowd_(experiment, bodies_, make_steering ? make_steering : bySocialForce, start_utime),
      encounters_(bodyRadii(experiment), experiment.pedestrians.body_radius_m) {}

std::vector<World::Vehicle> World::vehiclesOf(const config::Experiment& experiment) const {
  std::vector<Vehicle> vehicles;
  const std::vector<config::Start> starts = startPlaces(experiment);
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const config::Vehicle& vehicle = experiment.vehicles[i];
    auto dynamics = makeDynamics(vehicle, experiment.sim, starts[i], experiment.file);
    const VehicleAutopilot::Limits limits{experiment.sim.command_hold_s,
                                          experiment.sim.command_land_s, dynamics->commandDelayS(),
                                          vehicle.top_speed_mps, config::flies(vehicle)};
    vehicles.push_back(
        {std::move(dynamics), VehicleAutopilot(limits), pushesOn(vehicle.name, experiment.sim)});
  }
  return vehicles;
}

std::vector<BodyState> World::bodiesOf(const std::vector<Vehicle>& vehicles) {
  std::vector<BodyState> bodies;
  for (const Vehicle& vehicle : vehicles) {
    bodies.push_back(vehicle.dynamics->body());
  }
  return bodies;
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
    wheels_[i] = vehicle.dynamics->wheels();
  }
  now_ += step_us_;
  crowd_.step(now_, step_s, bodies_);
  contacts_.update(now_, step_us_, bodies_);
  encounters_.update(now_, bodies_, crowd_.people());
}

}  // namespace roundabout::sim
