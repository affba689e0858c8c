#pragma once

// One vehicle flown by hand: tests say what they command and look at the truth.

#include <functional>
#include <string>

#include "common/config/experiment.h"
#include "common/core/vehicle_state.h"
#include "sim/world.h"

namespace roundabout::sim {

class Flight {
 public:
  explicit Flight(const std::string& model, config::Sim sim = {})
      : experiment_(oneVehicle(model, std::move(sim))), world_(experiment_, kBegin) {}

  static config::Experiment oneVehicle(const std::string& model, config::Sim sim) {
    config::Experiment experiment;
    experiment.sim = std::move(sim);
    experiment.vehicles.resize(1);
    experiment.vehicles[0].name = "hex1";
    experiment.vehicles[0].model = model;
    experiment.vehicles[0].start = config::Start{};
    return experiment;
  }

  const BodyState& body() const { return world_.bodies()[0]; }
  const config::Vehicle& vehicle() const { return experiment_.vehicles[0]; }
  double speed() const { return body().velocity_world_mps.norm(); }
  double height() const { return body().position_world_m.z(); }
  World& world() { return world_; }

  /// Called after every step of the world.
  void watch(std::function<void()> watcher) { watcher_ = std::move(watcher); }

  core::Command position(double x, double y, double z) const {
    core::Command command = of(core::CommandMode::kPosition);
    command.position_world_m = {x, y, z};
    return command;
  }
  core::Command velocity(double x, double y) const {
    core::Command command = of(core::CommandMode::kVelocity);
    command.velocity_world_mps = {x, y, 0.0};
    command.position_world_m.z() = vehicle().height_m;
    command.heading_world_rad = std::atan2(y, x);
    return command;
  }
  core::Command of(core::CommandMode mode) const {
    core::Command command;
    command.mode = mode;
    command.valid_for_s = 0.3;
    return command;
  }

  /// Sends the command at 10 Hz, as a planner does.
  void fly(core::Command command, double seconds) {
    const core::Utime end = world_.now() + core::toUtime(seconds);
    while (world_.now() < end) {
      command.utime = world_.now();
      world_.accept(0, command);
      glide(0.1);
    }
  }

  /// Sends nothing.
  void glide(double seconds) {
    const core::Utime end = world_.now() + core::toUtime(seconds);
    while (world_.now() < end) {
      world_.step();
      if (watcher_) {
        watcher_();
      }
    }
  }

  void takeOff() { fly(position(0.0, 0.0, vehicle().height_m), 6.0); }

 private:
  static constexpr core::Utime kBegin = core::kMicrosPerSecond;

  config::Experiment experiment_;
  World world_;
  std::function<void()> watcher_;
};

}  // namespace roundabout::sim
