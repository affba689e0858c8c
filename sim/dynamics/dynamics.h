#pragma once

#include <Eigen/Geometry>

#include "common/config/experiment.h"

namespace roundabout::sim {

inline constexpr double kGravityMps2 = 9.81;

/// The truth about one vehicle. World frame. The floor is z = 0, where the centre of a flying
/// vehicle's body is when it rests.
struct BodyState {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< body to world
  bool motors_on = false;
  bool on_floor = true;  ///< something carries it; always so for models that do not fly
};

/// What a vehicle's controllers are to do now.
enum class Guidance {
  kMotorsOff,
  kVelocity,  ///< fly the horizontal velocity at the position's height
  kPosition,  ///< fly to the position
  kBrake,     ///< stop, in all three directions
  kDescend    ///< sink to the floor above the position's place; models that do not fly stand
};

struct Setpoint {
  Guidance guidance = Guidance::kMotorsOff;
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  double heading_world_rad = 0.0;
  double heading_rate_radps = 0.0;  ///< feed-forward
};

/// Of the rims of a robot's wheels on the floor. m/s.
struct WheelSpeeds {
  double left_mps = 0.0;
  double right_mps = 0.0;
};

/// A vehicle with its inner controllers, at rest with its motors off when made. Deterministic;
/// step() allocates nothing.
class Dynamics {
 public:
  Dynamics() = default;
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;
  virtual ~Dynamics() = default;

  /// Advances by step_s with the set-point held. The push is an acceleration from outside,
  /// horizontal, world frame.
  virtual void step(const Setpoint& setpoint, const Eigen::Vector2d& push_mps2, double step_s) = 0;

  virtual const BodyState& body() const = 0;

  /// From the arrival of a command to its first effect.
  virtual double commandDelayS() const = 0;

  /// What its wheel encoders count; zero for models without wheels.
  virtual WheelSpeeds wheels() const { return {}; }
};

}  // namespace roundabout::sim
