#include "common/bus/messages.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace roundabout::bus {

namespace {

constexpr double kUnitTolerance = 0.01;

template <std::size_t kSize>
bool allFinite(const double (&values)[kSize]) {
  return std::all_of(std::begin(values), std::end(values),
                     [](double v) { return std::isfinite(v); });
}

template <class Vector>
void copyTo(double (&target)[3], const Vector& source) {
  target[0] = source.x();
  target[1] = source.y();
  target[2] = source.z();
}

Eigen::Vector3d vectorOf(const double (&values)[3]) { return {values[0], values[1], values[2]}; }

}  // namespace

roundabout_msgs::vehicle_states_t toMessage(const core::StatesFrame& frame) {
  roundabout_msgs::vehicle_states_t message;
  message.utime = frame.utime;
  message.frame_number = frame.frame_number;
  message.exposure_utime = frame.exposure_utime == 0 ? frame.utime : frame.exposure_utime;
  message.num_vehicles = static_cast<std::int32_t>(frame.vehicles.size());
  message.vehicles.resize(frame.vehicles.size());
  for (std::size_t i = 0; i < frame.vehicles.size(); ++i) {
    const core::VehicleState& state = frame.vehicles[i];
    roundabout_msgs::vehicle_state_t& out = message.vehicles[i];
    out.name = state.name;
    copyTo(out.position, state.position_world_m);
    copyTo(out.velocity, state.velocity_world_mps);
    out.orientation[0] = state.orientation.w();
    out.orientation[1] = state.orientation.x();
    out.orientation[2] = state.orientation.y();
    out.orientation[3] = state.orientation.z();
    copyTo(out.angular_velocity, state.angular_velocity_body_radps);
    out.tracked = state.tracked ? 1 : 0;
    out.predicted = state.predicted ? 1 : 0;
    out.last_seen = state.last_seen;
  }
  return message;
}

roundabout_msgs::command_t toMessage(const core::Command& command) {
  roundabout_msgs::command_t message;
  message.utime = command.utime;
  message.state_utime = command.state_utime;
  message.vehicle = command.vehicle;
  message.mode = static_cast<std::int8_t>(command.mode);
  copyTo(message.velocity, command.velocity_world_mps);
  copyTo(message.position, command.position_world_m);
  message.heading = command.heading_world_rad;
  message.heading_rate = command.heading_rate_radps;
  message.valid_for = command.valid_for_s;
  message.goal[0] = command.goal_world_m.x();
  message.goal[1] = command.goal_world_m.y();
  message.asks_for_way = command.asks_for_way ? 1 : 0;
  return message;
}

roundabout_msgs::goal_t toMessage(const core::Goal& goal) {
  roundabout_msgs::goal_t message;
  message.utime = goal.utime;
  message.vehicle = goal.vehicle;
  message.goal_id = goal.goal_id;
  copyTo(message.position, goal.position_world_m);
  message.heading = goal.heading_world_rad;
  message.phase = static_cast<std::int8_t>(goal.phase);
  return message;
}

roundabout_msgs::safety_order_t toMessage(const core::SafetyOrder& order) {
  roundabout_msgs::safety_order_t message;
  message.utime = order.utime;
  message.vehicle = order.vehicle;
  message.order = static_cast<std::int8_t>(order.order);
  return message;
}

int fromMessage(const roundabout_msgs::vehicle_states_t& message, core::StatesFrame& frame) {
  int unusable = 0;
  frame.utime = message.utime;
  frame.frame_number = message.frame_number;
  frame.exposure_utime = message.exposure_utime;
  frame.vehicles.resize(message.vehicles.size());
  for (std::size_t i = 0; i < message.vehicles.size(); ++i) {
    const roundabout_msgs::vehicle_state_t& in = message.vehicles[i];
    core::VehicleState& state = frame.vehicles[i];
    const Eigen::Quaterniond orientation(in.orientation[0], in.orientation[1], in.orientation[2],
                                         in.orientation[3]);
    state = core::VehicleState();
    state.name = in.name;
    state.last_seen = in.last_seen;
    if (!allFinite(in.position) || !allFinite(in.velocity) || !allFinite(in.angular_velocity) ||
        !(std::abs(orientation.norm() - 1.0) <= kUnitTolerance)) {
      ++unusable;
      continue;
    }
    state.position_world_m = vectorOf(in.position);
    state.velocity_world_mps = vectorOf(in.velocity);
    state.orientation = orientation;
    state.angular_velocity_body_radps = vectorOf(in.angular_velocity);
    state.tracked = in.tracked != 0;
    state.predicted = in.predicted != 0;
  }
  return unusable;
}

const char* fromMessage(const roundabout_msgs::command_t& message, core::Command& command) {
  if (!allFinite(message.velocity) || !allFinite(message.position) ||
      !std::isfinite(message.heading) || !std::isfinite(message.heading_rate) ||
      !std::isfinite(message.valid_for) || std::isinf(message.goal[0]) ||
      std::isinf(message.goal[1])) {
    return "not a finite number";
  }
  if (message.mode < roundabout_msgs::command_t::VELOCITY ||
      message.mode > roundabout_msgs::command_t::KILL) {
    return "unknown mode";
  }
  command.utime = message.utime;
  command.state_utime = message.state_utime;
  command.vehicle = message.vehicle;
  command.mode = static_cast<core::CommandMode>(message.mode);
  command.velocity_world_mps = vectorOf(message.velocity);
  command.position_world_m = vectorOf(message.position);
  command.heading_world_rad = message.heading;
  command.heading_rate_radps = message.heading_rate;
  command.valid_for_s = message.valid_for;
  command.goal_world_m = {message.goal[0], message.goal[1]};
  command.asks_for_way = message.asks_for_way != 0;
  return nullptr;
}

const char* fromMessage(const roundabout_msgs::goal_t& message, core::Goal& goal) {
  if (!allFinite(message.position) || std::isinf(message.heading)) {
    return "not a finite number";
  }
  if (message.phase < roundabout_msgs::goal_t::TAKE_OFF ||
      message.phase > roundabout_msgs::goal_t::LAND) {
    return "unknown phase";
  }
  goal.utime = message.utime;
  goal.vehicle = message.vehicle;
  goal.goal_id = message.goal_id;
  goal.position_world_m = vectorOf(message.position);
  goal.heading_world_rad = message.heading;
  goal.phase = static_cast<core::GoalPhase>(message.phase);
  return nullptr;
}

const char* fromMessage(const roundabout_msgs::safety_order_t& message, core::SafetyOrder& order) {
  if (message.order < roundabout_msgs::safety_order_t::HOLD ||
      message.order > roundabout_msgs::safety_order_t::RESUME) {
    return "unknown order";
  }
  order.utime = message.utime;
  order.vehicle = message.vehicle;
  order.order = static_cast<core::SafetyOrderKind>(message.order);
  return nullptr;
}

roundabout_msgs::planar_lidar_t toMessage(const core::LaserScan& scan) {
  roundabout_msgs::planar_lidar_t message;
  message.utime = scan.utime;
  message.nranges = static_cast<std::int32_t>(scan.ranges_m.size());
  message.ranges = scan.ranges_m;
  message.nintensities = 0;
  message.rad0 = static_cast<float>(scan.first_angle_rad);
  message.radstep = static_cast<float>(scan.angle_step_rad);
  return message;
}

const char* fromMessage(const roundabout_msgs::planar_lidar_t& message, core::LaserScan& scan) {
  if (!std::isfinite(message.rad0) || !std::isfinite(message.radstep)) {
    return "an angle is not finite";
  }
  if (message.nranges > kMostRanges) {
    return "more ranges than any lidar has";
  }
  scan.utime = message.utime;
  scan.first_angle_rad = double{message.rad0};
  scan.angle_step_rad = double{message.radstep};
  scan.ranges_m = message.ranges;
  return nullptr;
}

}  // namespace roundabout::bus
