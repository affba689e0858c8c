#pragma once

// Messages to the plain structs of common/core and back, with the checks that every receiver needs.

#include <string>

#include "common/core/agent_tracks.h"
#include "common/core/command.h"
#include "common/core/laser_scan.h"
#include "common/core/sensor_data.h"
#include "common/core/vehicle_state.h"
#include "roundabout_msgs/agent_tracks_t.hpp"
#include "roundabout_msgs/command_t.hpp"
#include "roundabout_msgs/goal_t.hpp"
#include "roundabout_msgs/image_t.hpp"
#include "roundabout_msgs/occupancy_t.hpp"
#include "roundabout_msgs/odometry_t.hpp"
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
inline std::string imageChannel(const std::string& vehicle, const std::string& camera) {
  return "IMAGE_" + vehicle + "_" + camera;
}
inline std::string odometryChannel(const std::string& vehicle) { return "ODOMETRY_" + vehicle; }
inline constexpr const char* kAgentTracksPrefix = "AGENT_TRACKS_";
inline std::string agentTracksChannel(const std::string& vehicle) {
  return kAgentTracksPrefix + vehicle;
}
inline std::string occupancyChannel(const std::string& vehicle) { return "OCCUPANCY_" + vehicle; }
/// Where the simulator publishes its pedestrians, as agent_tracks_t. Nothing that drives listens.
inline constexpr const char* kPedestrianTruthChannel = "PEDESTRIAN_TRUTH";

roundabout_msgs::vehicle_states_t toMessage(const core::StatesFrame& frame);
roundabout_msgs::command_t toMessage(const core::Command& command);
roundabout_msgs::goal_t toMessage(const core::Goal& goal);
roundabout_msgs::safety_order_t toMessage(const core::SafetyOrder& order);
roundabout_msgs::planar_lidar_t toMessage(const core::LaserScan& scan);
roundabout_msgs::agent_tracks_t toMessage(const core::AgentTracks& tracks);
roundabout_msgs::image_t toMessage(const core::JpegImage& image);
roundabout_msgs::image_t toMessage(const core::DepthImage& image);
roundabout_msgs::occupancy_t toMessage(const core::OccupancyMap& map);
roundabout_msgs::odometry_t toMessage(const core::Odometry& odometry);

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

/// Tracks with a number that is not finite, a radius that is not positive, a negative deviation or
/// an unknown class are left out: an agent elsewhere must not become invisible by them. `left_out`
/// says how many; who drives by the rest is told that somebody is missing.
inline constexpr std::int32_t kMostTracks = 512;
const char* fromMessage(const roundabout_msgs::agent_tracks_t& message, core::AgentTracks& tracks,
                        int& left_out);

/// A datagram over UDP holds 64 kB; larger messages are fragmented and vanish without a word.
inline constexpr std::size_t kMostImageBytes = 60'000;
/// Not a JPEG, or a size that no camera has. Whether the JPEG can be decoded is seen when it is.
const char* fromMessage(const roundabout_msgs::image_t& message, core::JpegImage& image);
/// Not 16 bits of grey a pixel, a size that no camera has, or rows that are not width pixels long.
const char* fromMessage(const roundabout_msgs::image_t& message, core::DepthImage& image);
const char* fromMessage(const roundabout_msgs::occupancy_t& message, core::OccupancyMap& map);
const char* fromMessage(const roundabout_msgs::odometry_t& message, core::Odometry& odometry);

}  // namespace roundabout::bus
