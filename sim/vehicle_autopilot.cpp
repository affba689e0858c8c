#include "sim/vehicle_autopilot.h"

#include <algorithm>

#include "common/core/vehicle_state.h"

namespace roundabout::sim {

using core::CommandMode;
using core::toSeconds;

namespace {

constexpr double kStoppedMps = 0.1;
// Something keeps pushing it: it will not get slower than this.
constexpr core::Utime kLongestBrakeUs = 2 * core::kMicrosPerSecond;

}  // namespace

VehicleAutopilot::VehicleAutopilot(const Limits& limits)
    : limits_(limits), delay_us_(core::toUtime(limits.command_delay_s)) {
  on_the_way_.reserve(16);
}

const char* VehicleAutopilot::accept(const core::Command& command, core::Utime now) {
  if (command.mode != CommandMode::kKill) {
    if (command.utime < last_decided_) {
      return "older than the command before";
    }
    if (toSeconds(command.utime - now) > kLargestLeadS) {
      return "from the future";
    }
    if (toSeconds(now - command.utime) > command.valid_for_s) {
      return "expired";
    }
    last_decided_ = command.utime;
  }

  Order order;
  order.mode = command.mode;
  order.decided = command.utime;
  order.arrived = now;
  order.valid_for_s = command.valid_for_s;
  order.setpoint.guidance =
      command.mode == CommandMode::kVelocity ? Guidance::kVelocity : Guidance::kPosition;
  const Eigen::Vector2d velocity = command.velocity_world_mps.head<2>();
  order.setpoint.velocity_world_mps =
      velocity * std::min(1.0, limits_.top_speed_mps / std::max(velocity.norm(), 1e-9));
  order.setpoint.position_world_m = command.position_world_m;
  order.setpoint.heading_world_rad = command.heading_world_rad;
  order.setpoint.heading_rate_radps = command.heading_rate_radps;
  on_the_way_.push_back(order);
  return nullptr;
}

const Setpoint& VehicleAutopilot::update(core::Utime now, const BodyState& body) {
  while (!on_the_way_.empty() && on_the_way_.front().arrived + delay_us_ <= now) {
    current_ = on_the_way_.front();
    on_the_way_.erase(on_the_way_.begin());
    commanded_ = true;
  }

  const CommandMode wanted = wantedMode(now);
  if (wanted == CommandMode::kKill) {
    stopMotors();
  }
  if (!motors_on_) {
    if (!startsMotors(wanted, body)) {
      return setpoint_;
    }
    motors_on_ = true;
  }

  const bool entering = active_ != wanted;
  active_ = wanted;
  if (wanted == CommandMode::kHold) {
    brakeThen(Guidance::kPosition, entering, now, body);
  } else if (wanted == CommandMode::kLand) {
    brakeThen(Guidance::kDescend, entering, now, body);
    if (setpoint_.guidance == Guidance::kDescend && body.on_floor) {
      stopMotors();
    }
  } else {
    setpoint_ = current_.setpoint;
  }
  return setpoint_;
}

CommandMode VehicleAutopilot::wantedMode(core::Utime now) const {
  if (!commanded_) {
    return CommandMode::kHold;
  }
  const double silence_s = toSeconds(now - current_.arrived);
  const bool valid =
      silence_s <= limits_.hold_s && toSeconds(now - current_.decided) <= current_.valid_for_s;
  if (valid || current_.mode == CommandMode::kLand || current_.mode == CommandMode::kKill) {
    return current_.mode;
  }
  return silence_s > limits_.land_s ? CommandMode::kLand : CommandMode::kHold;
}

bool VehicleAutopilot::startsMotors(CommandMode wanted, const BodyState& body) const {
  if (!limits_.flies) {
    return wanted == CommandMode::kPosition || wanted == CommandMode::kVelocity;
  }
  const double climb = current_.setpoint.position_world_m.z() - body.position_world_m.z();
  return wanted == CommandMode::kPosition && body.on_floor && climb >= kTakeOffMarginM;
}

void VehicleAutopilot::stopMotors() {
  motors_on_ = false;
  active_.reset();
  setpoint_ = Setpoint();
}

void VehicleAutopilot::brakeThen(Guidance next, bool entering, core::Utime now,
                                 const BodyState& body) {
  if (entering) {
    braking_ = true;
    braking_since_ = now;
    setpoint_ = Setpoint();
    setpoint_.guidance = Guidance::kBrake;
    setpoint_.heading_world_rad = core::headingOf(body.orientation);
  }
  const bool stopped = body.velocity_world_mps.norm() < kStoppedMps;
  if (braking_ && (stopped || now - braking_since_ > kLongestBrakeUs)) {
    braking_ = false;
    setpoint_.guidance = next;
    setpoint_.position_world_m = body.position_world_m;
  }
}

}  // namespace roundabout::sim
