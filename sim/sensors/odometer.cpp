#include "sim/sensors/odometer.h"

#include <cmath>

#include "common/core/angles.h"
#include "common/core/vehicle_state.h"

namespace roundabout::sim {

Odometer::Odometer(const config::GroundRobotModel& model, const std::string& name,
                   std::uint64_t seed, const BodyState& start)
    : model_(model), random_(seed, "odometry/" + name) {
  left_scale_ = 1.0 + random_.normal(model.odometry.wheel_error);
  right_scale_ = 1.0 + random_.normal(model.odometry.wheel_error);
  state_.vehicle = name;
  state_.position_world_m = start.position_world_m.head<2>();
  state_.heading_world_rad = core::headingOf(start.orientation);
}

void Odometer::step(const WheelSpeeds& wheels, double step_s) {
  // Errors of independent steps add up to slip_m after a metre.
  const auto counted = [&](double speed_mps, double scale) {
    const double way_m = speed_mps * step_s;
    return scale * way_m + random_.normal(model_.odometry.slip_m * std::sqrt(std::abs(way_m)));
  };
  const double left_m = counted(wheels.left_mps, left_scale_);
  const double right_m = counted(wheels.right_mps, right_scale_);
  const double turn_rad = (right_m - left_m) / model_.wheel_base_m;
  const double way_m = 0.5 * (left_m + right_m);
  const double middle_rad = state_.heading_world_rad + 0.5 * turn_rad;
  state_.position_world_m += way_m * Eigen::Vector2d(std::cos(middle_rad), std::sin(middle_rad));
  state_.heading_world_rad += turn_rad;
  state_.speed_mps = 0.5 * (wheels.left_mps * left_scale_ + wheels.right_mps * right_scale_);
  state_.turn_rate_radps =
      (wheels.right_mps * right_scale_ - wheels.left_mps * left_scale_) / model_.wheel_base_m;
}

core::Odometry Odometer::reading(core::Utime utime) const {
  core::Odometry odometry = state_;
  odometry.utime = utime;
  return odometry;
}

BodyState Odometer::believed(const BodyState& truth) const {
  BodyState body = truth;
  body.position_world_m.head<2>() = state_.position_world_m;
  body.orientation = Eigen::AngleAxisd(state_.heading_world_rad, Eigen::Vector3d::UnitZ());
  return body;
}

Odometers::Odometers(const config::Experiment& experiment, std::span<const BodyState> bodies) {
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const config::Vehicle& vehicle = experiment.vehicles[i];
    if (vehicle.model == "ground_robot") {
      const config::GroundRobotModel& model = experiment.sim.ground_robot;
      robots_.push_back({i, vehicle.localised_by == "odometry",
                         Odometer(model, vehicle.name, experiment.seed, bodies[i]),
                         core::TickTimer(model.odometry.rate_hz)});
    }
  }
}

void Odometers::step(std::span<const WheelSpeeds> wheels, double step_s) {
  for (Robot& robot : robots_) {
    robot.odometer.step(wheels[robot.vehicle], step_s);
  }
}

std::span<const BodyState> Odometers::believed(std::span<const BodyState> bodies) {
  believed_.assign(bodies.begin(), bodies.end());
  for (const Robot& robot : robots_) {
    if (robot.localises) {
      believed_[robot.vehicle] = robot.odometer.believed(bodies[robot.vehicle]);
    }
  }
  return believed_;
}

core::Command Odometers::asDriven(std::size_t vehicle, const core::Command& command,
                                  std::span<const BodyState> bodies) const {
  core::Command driven = command;
  for (const Robot& robot : robots_) {
    if (robot.vehicle != vehicle || !robot.localises) {
      continue;
    }
    const BodyState& truth = bodies[vehicle];
    const BodyState believed = robot.odometer.believed(truth);
    const double turn_rad =
        core::headingOf(truth.orientation) - core::headingOf(believed.orientation);
    const Eigen::Rotation2Dd turn(turn_rad);
    driven.velocity_world_mps.head<2>() = turn * command.velocity_world_mps.head<2>();
    driven.position_world_m.head<2>() =
        truth.position_world_m.head<2>() +
        turn * (command.position_world_m - believed.position_world_m).head<2>();
    driven.heading_world_rad = core::wrapToPi(command.heading_world_rad + turn_rad);
  }
  return driven;
}

std::span<const Odometers::Reading> Odometers::read(core::Utime now) {
  readings_.clear();
  for (Robot& robot : robots_) {
    if (robot.timer.due(now)) {
      readings_.push_back({robot.vehicle, robot.odometer.reading(now)});
    }
  }
  return readings_;
}

}  // namespace roundabout::sim
