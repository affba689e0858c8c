#pragma once

// Messages to the plain structs of common/core and back, with the checks that every receiver needs.

#include <string>

#include "common/core/command.h"
#include "common/core/laser_scan.h"
#include "common/core/vehicle_state.h"
#include "roundabout_msgs/command_t.hpp"
#include "roundabout_msgs/goal_t.hpp"
#include "roundabout_msgs/planar_lidar_t.hpp"
#include "roundabout_msgs/safety_order_t.hpp"
#include "roundabout_msgs/vehicle_states_t.hpp"

namespace roundabout::bus {

inline constexpr const char* kStatesChannel = "VEHICLE_STATES";
/// Where `sim --scene` publishes what cameras would see, as vehicle_states_t, for an emulated
/// motion-capture system. Nothing that flies listens to it.
inline constexpr const char* kSceneChannel = "MOCAP_SCENE";
inline constexpr const char* kMissionChannel = "MISSION";
inline constexpr const char* kFleetStatusChannel = "FLEET_STATUS";
inline constexpr const char* kSafetyOrderChannel = "SAFETY_ORDER";
inline std::string goalChannel(const std::string& vehicle) { return "GOAL_" + vehicle; }
inline std::string commandChannel(const std::string& vehicle) { return "COMMAND_" + vehicle; }
inline constexpr const char* kPlannerStatusPrefix = "PLANNER_STATUS_";
inline std::string plannerStatusChannel(const std::string& vehicle) {
  return kPlannerStatusPrefix + vehicle;
}
inline std::string laserScanChannel(const std::string& vehicle) { return "LASER_SCAN_" + vehicle; }

roundabout_msgs::vehicle_states_t toMessage(const core::StatesFrame& frame);
roundabout_msgs::command_t toMessage(const core::Command& command);
roundabout_msgs::goal_t toMessage(const core::Goal& goal);
roundabout_msgs::safety_order_t toMessage(const core::SafetyOrder& order);
roundabout_msgs::planar_lidar_t toMessage(const core::LaserScan& scan);

/// Vehicles with a number that is not finite or an orientation that is not unit come out as not
/// tracked, with zero state, so that one broken body does not blind anybody to the others. Returns
/// how many those were.
int fromMessage(const roundabout_msgs::vehicle_states_t& message, core::StatesFrame& frame);

/// Each returns nullptr and fills the struct, or says in a few words why the message is not
/// acceptable: a number that is not finite, an unknown mode. Names and time order are the caller's
/// to check.
const char* fromMessage(const roundabout_msgs::command_t& message, core::Command& command);
const char* fromMessage(const roundabout_msgs::goal_t& message, core::Goal& goal);
const char* fromMessage(const roundabout_msgs::safety_order_t& message, core::SafetyOrder& order);
/// Single ranges may be anything; the angles must be finite, and there are at most kMostRanges.
inline constexpr std::int32_t kMostRanges = 8192;
const char* fromMessage(const roundabout_msgs::planar_lidar_t& message, core::LaserScan& scan);

}  // namespace roundabout::bus
