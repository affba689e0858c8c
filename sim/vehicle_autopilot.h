#pragma once

#include <optional>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"
#include "sim/dynamics/dynamics.h"

namespace roundabout::sim {

/// What flies on board between the radio and the controllers: takes commands, lets them expire and
/// does the vehicle's part of the safety table. The same for every model.
///
///   the latest command is valid          does what it says
///   none valid, or none for hold_s       holds: brakes, then keeps its position
///   none for land_s                      lands: brakes, descends, stops the motors on the floor
///   KILL                                 stops the motors, wherever it is
///
/// A landing that was commanded goes on when commands stop. Motors start only on the floor, and
/// only on a POSITION command that is kTakeOffMarginM above it; those of a vehicle that does not
/// fly start on VELOCITY too and from any height.
class VehicleAutopilot {
 public:
  static constexpr double kTakeOffMarginM = 0.1;
  /// Commands later than the vehicle's clock by more than this are refused.
  static constexpr double kLargestLeadS = 1.0;

  struct Limits {
    double hold_s;
    double land_s;
    double command_delay_s;
    double top_speed_mps;  ///< commanded horizontal velocities are clipped to it
    bool flies;
  };

  explicit VehicleAutopilot(const Limits& limits);

  /// Takes a command that arrives at `now` (data time). Returns nullptr, or why it is refused:
  /// older than the one before, from the future, or expired. KILL is never refused.
  const char* accept(const core::Command& command, core::Utime now);

  /// What the controllers are to do from `now` on. Times must not decrease.
  const Setpoint& update(core::Utime now, const BodyState& body);

 private:
  struct Order {
    core::CommandMode mode = core::CommandMode::kHold;
    Setpoint setpoint;  // of a VELOCITY or POSITION command
    core::Utime decided = 0;
    core::Utime arrived = 0;
    double valid_for_s = 0.0;
  };

  core::CommandMode wantedMode(core::Utime now) const;
  bool startsMotors(core::CommandMode wanted, const BodyState& body) const;
  void stopMotors();
  void brakeThen(Guidance next, bool entering, core::Utime now, const BodyState& body);

  const Limits limits_;
  const core::Utime delay_us_;
  std::vector<Order> on_the_way_;  // accepted, not yet in effect
  Order current_;
  bool commanded_ = false;
  core::Utime last_decided_ = 0;

  bool motors_on_ = false;
  std::optional<core::CommandMode> active_;  // what setpoint_ was made for; nothing: motors off
  bool braking_ = false;
  core::Utime braking_since_ = 0;
  Setpoint setpoint_;
};

}  // namespace roundabout::sim
