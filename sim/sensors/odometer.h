#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "common/core/random.h"
#include "common/core/sensor_data.h"
#include "common/core/tick_timer.h"
#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// Dead reckoning by two wheels: each counts its own way a constant share wrong, and slips at
/// random. So heading and place drift. Random numbers come from the stream "odometry/<name>".
class Odometer {
 public:
  Odometer(const config::GroundRobotModel& model, const std::string& name, std::uint64_t seed,
           const BodyState& start);

  void step(const WheelSpeeds& wheels, double step_s);

  core::Odometry reading(core::Utime utime) const;
  /// What a localiser makes of it that has nothing else.
  BodyState believed(const BodyState& truth) const;

 private:
  const config::GroundRobotModel model_;
  core::RandomStream random_;
  double left_scale_;
  double right_scale_;
  core::Odometry state_;
};

/// The odometry of an experiment's ground robots.
class Odometers {
 public:
  struct Reading {
    std::size_t vehicle;
    core::Odometry odometry;
  };

  /// bodies: where they start; all spans in the order of the experiment.
  Odometers(const config::Experiment& experiment, std::span<const BodyState> bodies);

  void step(std::span<const WheelSpeeds> wheels, double step_s);

  /// The truth, but of vehicles that are localised by odometry what that says. Valid until the next
  /// call.
  std::span<const BodyState> believed(std::span<const BodyState> bodies);
  /// What a command comes to in the world: a robot that is localised by odometry drives to places
  /// and in directions as it believes them to be.
  core::Command asDriven(std::size_t vehicle, const core::Command& command,
                         std::span<const BodyState> bodies) const;
  /// Those that are due. Valid until the next call.
  std::span<const Reading> read(core::Utime now);

 private:
  struct Robot {
    std::size_t vehicle;
    bool localises;
    Odometer odometer;
    core::TickTimer timer;
  };

  std::vector<Robot> robots_;
  std::vector<BodyState> believed_;
  std::vector<Reading> readings_;
};

}  // namespace roundabout::sim
