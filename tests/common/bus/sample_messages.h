#pragma once

// One valid message of every type, with an element in every list.

#include <string>

#include "roundabout_msgs/agent_tracks_t.hpp"
#include "roundabout_msgs/command_t.hpp"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/goal_t.hpp"
#include "roundabout_msgs/image_t.hpp"
#include "roundabout_msgs/mission_t.hpp"
#include "roundabout_msgs/occupancy_t.hpp"
#include "roundabout_msgs/odometry_t.hpp"
#include "roundabout_msgs/planar_lidar_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"
#include "roundabout_msgs/safety_order_t.hpp"
#include "roundabout_msgs/vehicle_states_t.hpp"

namespace roundabout::bus {

template <class Message>
Message sample();

template <>
inline roundabout_msgs::vehicle_states_t sample() {
  roundabout_msgs::vehicle_states_t message{};
  message.utime = 1'005'000;
  message.frame_number = 1;
  message.exposure_utime = 1'002'000;
  message.num_vehicles = 2;
  message.vehicles.resize(2);
  for (int i = 0; i < 2; ++i) {
    roundabout_msgs::vehicle_state_t& state = message.vehicles[static_cast<std::size_t>(i)];
    state = {};
    state.name = "hex" + std::to_string(i + 1);
    state.position[0] = 1.5 + i;
    state.position[2] = 1.0;
    state.velocity[1] = -0.5;
    state.orientation[0] = 0.6;
    state.orientation[3] = 0.8;
    state.angular_velocity[2] = 0.25;
    state.tracked = 1;
    state.last_seen = 1'005'000;
  }
  return message;
}

template <>
inline roundabout_msgs::command_t sample() {
  roundabout_msgs::command_t message{};
  message.utime = 2;
  message.state_utime = 1;
  message.vehicle = "hex1";
  message.mode = roundabout_msgs::command_t::POSITION;
  message.velocity[0] = 0.5;
  message.position[2] = 1.0;
  message.heading = -1.5;
  message.heading_rate = 0.25;
  message.valid_for = 0.3;
  return message;
}

template <>
inline roundabout_msgs::planar_lidar_t sample() {
  roundabout_msgs::planar_lidar_t message{};
  message.utime = 1'005'000;
  message.nranges = 3;
  message.ranges = {1.5F, 6.0F, 0.25F};
  message.nintensities = 2;
  message.intensities = {0.5F, 0.75F};
  message.rad0 = -1.5F;
  message.radstep = 1.5F;
  return message;
}

template <>
inline roundabout_msgs::goal_t sample() {
  roundabout_msgs::goal_t message{};
  message.utime = 3;
  message.vehicle = "hex1";
  message.goal_id = 1000;
  message.position[1] = 2.0;
  message.heading = 0.5;
  message.phase = roundabout_msgs::goal_t::GO;
  return message;
}

template <>
inline roundabout_msgs::safety_order_t sample() {
  roundabout_msgs::safety_order_t message{};
  message.utime = 4;
  message.vehicle = "hex1";
  message.order = roundabout_msgs::safety_order_t::LAND;
  return message;
}

template <>
inline roundabout_msgs::mission_t sample() {
  roundabout_msgs::mission_t message{};
  message.utime = 5;
  message.num_points = 2;
  message.points = {{1.0, 2.0, 1.0}, {3.0, 4.0, 1.0}};
  message.mission_id = 1'000'000;
  message.verb = "formation";
  message.text = "pair";
  message.seconds = 1.0;
  return message;
}

template <>
inline roundabout_msgs::planner_status_t sample() {
  roundabout_msgs::planner_status_t message{};
  message.utime = 6;
  message.num_actions = 3;
  message.action_probabilities = {0.25F, 0.5F, 0.25F};
  message.vehicle = "hex1";
  message.policy = "orca";
  message.mode = roundabout_msgs::planner_status_t::FLYING;
  message.reason = "all well";
  message.order_utime = 5;
  message.goal_id = 1000;
  return message;
}

template <>
inline roundabout_msgs::fleet_status_t sample() {
  roundabout_msgs::fleet_status_t message{};
  message.utime = 7;
  message.num_vehicles = 1;
  message.num_refusals = 2;
  message.vehicles.resize(1);
  message.vehicles[0] = {};
  message.vehicles[0].vehicle = "hex1";
  message.refusals = {"too close", "too many"};
  message.phase = roundabout_msgs::fleet_status_t::GO;
  message.formation = "C";
  message.reason = "hex1 is on its way";
  return message;
}

template <>
inline roundabout_msgs::agent_tracks_t sample() {
  roundabout_msgs::agent_tracks_t message{};
  message.utime = 8;
  message.num_tracks = 2;
  message.tracks.resize(2);
  for (int i = 0; i < 2; ++i) {
    roundabout_msgs::agent_track_t& track = message.tracks[static_cast<std::size_t>(i)];
    track = {};
    track.id = 17 + i;
    track.agent_class = roundabout_msgs::agent_track_t::PEDESTRIAN;
    track.confidence = 0.75;
    track.position[0] = 1.5;
    track.position[1] = -0.5 + i;
    track.velocity[0] = 1.25;
    track.velocity[1] = -0.25;
    track.radius = 0.375;
    track.position_deviation = 0.0625;
    track.velocity_deviation = 0.125;
    track.age = 2.5;
    track.unseen = 0.5;
  }
  message.vehicle = "rover";
  message.health = roundabout_msgs::agent_tracks_t::DEGRADED;
  message.reason = "no image for 2 s";
  message.rejected_scans = 1;
  message.rejected_ranges = 2;
  message.rejected_images = 3;
  message.rejected_poses = 4;
  message.compute_time = 0.25;
  return message;
}

template <>
inline roundabout_msgs::image_t sample() {
  roundabout_msgs::image_t message{};
  message.utime = 1'005'000;
  message.width = 320;
  message.height = 240;
  message.pixelformat = roundabout_msgs::image_t::PIXEL_FORMAT_MJPEG;
  message.data = {0xFF, 0xD8, 0xFF, 0xE0, 0x17};
  message.size = 5;
  message.nmetadata = 1;
  message.metadata.resize(1);
  message.metadata[0].key = "exposure";
  message.metadata[0].n = 2;
  message.metadata[0].value = {1, 2};
  return message;
}

template <>
inline roundabout_msgs::occupancy_t sample() {
  roundabout_msgs::occupancy_t message{};
  message.utime = 9;
  message.num_bytes = 3;
  message.tree = {7, 8, 9};
  message.vehicle = "rover";
  message.resolution = 0.0625;
  return message;
}

template <>
inline roundabout_msgs::odometry_t sample() {
  roundabout_msgs::odometry_t message{};
  message.utime = 10;
  message.vehicle = "rover";
  message.position[0] = -3.0;
  message.position[1] = 0.5;
  message.heading = 7.0;
  message.speed = 1.25;
  message.turn_rate = -0.5;
  return message;
}

}  // namespace roundabout::bus
