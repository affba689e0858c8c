#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "sim/contacts.h"
#include "sim/dynamics/dynamics.h"
#include "sim/pedestrians/crowd.h"
#include "sim/pedestrians/encounters.h"
#include "sim/vehicle_autopilot.h"

namespace roundabout::sim {

/// The truth: every vehicle and every pedestrian of an experiment on one clock. Knows no messages
/// and no noise. Vehicles are numbered in the order of the experiment file.
class World {
 public:
  /// Throws core::StartupError: unknown model, no place to start, or as Crowd.
  /// make_steering: of pedestrians; without it they walk by social forces.
  World(const config::Experiment& experiment, core::Utime start_utime,
        const SteeringFactory& make_steering = {});

  core::Utime now() const { return now_; }
  core::Utime stepUs() const { return step_us_; }

  /// A command that reaches the vehicle now. Returns nullptr, or why the vehicle refuses it.
  const char* accept(std::size_t vehicle, const core::Command& command);

  /// Advances everything by stepUs().
  void step();

  std::span<const BodyState> bodies() const { return bodies_; }
  std::span<const WheelSpeeds> wheels() const { return wheels_; }
  const Contacts& contacts() const { return contacts_; }
  std::span<const Pedestrian> people() const { return crowd_.people(); }
  const Encounters& encounters() const { return encounters_; }

 private:
  struct TimedPush {
    core::Utime begin;
    core::Utime end;
    Eigen::Vector2d acceleration_mps2;
  };
  struct Vehicle {
    std::unique_ptr<Dynamics> dynamics;
    VehicleAutopilot autopilot;
    std::vector<TimedPush> pushes;
  };

  std::vector<Vehicle> vehiclesOf(const config::Experiment& experiment) const;
  static std::vector<BodyState> bodiesOf(const std::vector<Vehicle>& vehicles);
  std::vector<TimedPush> pushesOn(const std::string& name, const config::Sim& sim) const;

  core::Utime now_;
  core::Utime step_us_;
  std::vector<Vehicle> vehicles_;
  std::vector<BodyState> bodies_;
  std::vector<WheelSpeeds> wheels_;
  Contacts contacts_;
  Crowd crowd_;
  Encounters encounters_;
};

}  // namespace roundabout::sim
