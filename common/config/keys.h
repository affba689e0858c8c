#pragma once

// Every key of an experiment file, once: its name, where its value goes and what the value must
// fulfil. The reader, the writer and the tests of the documentation are visitors that these
// functions are called with; a visitor is called as visitor(key, member, constraint).

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/config/constraint.h"
#include "common/config/experiment.h"
#include "common/config/mocap_protocols.h"

namespace roundabout::config {

template <class Visitor>
void describe(Visitor& visit, Room& room) {
  visit("min_m", room.min_m);
  visit("max_m", room.max_m);
}

template <class Visitor>
void describe(Visitor& visit, Obstacle& obstacle) {
  visit("name", obstacle.name, identifier());
  visit("points_m", obstacle.points_m);
}

template <class Visitor>
void describe(Visitor& visit, Start& start) {
  visit("position_m", start.position_m);
  visit("heading_rad", start.heading_rad);
}

template <class Visitor>
void describe(Visitor& visit, Lidar& lidar) {
  visit("beams", lidar.beams, between(2.0, 4096.0));
  visit("field_of_view_rad", lidar.field_of_view_rad, between(0.01, 6.2831854));
  visit("max_range_m", lidar.max_range_m, above(0.0));
  visit("rate_hz", lidar.rate_hz, above(0.0));
  visit("noise_m", lidar.noise_m, atLeast(0.0));
  visit("sees_room_walls", lidar.sees_room_walls);
  visit("missed_share", lidar.missed_share, between(0.0, 1.0));
  visit("mixed_share", lidar.mixed_share, between(0.0, 1.0));
  visit("sweep_s", lidar.sweep_s, between(0.0, 1.0));
}

template <class Visitor>
void describe(Visitor& visit, DepthSensing& depth) {
  visit("nearest_m", depth.nearest_m, between(0.0, 65.0));
  visit("farthest_m", depth.farthest_m, between(0.1, 65.0));
  visit("noise_per_m", depth.noise_per_m, between(0.0, 0.1));
  visit("missed_share", depth.missed_share, between(0.0, 1.0));
}

template <class Visitor>
void describe(Visitor& visit, Camera& camera) {
  visit("name", camera.name, identifier());
  visit("width", camera.width, between(16.0, 4096.0));
  visit("height", camera.height, between(16.0, 4096.0));
  visit("field_of_view_rad", camera.field_of_view_rad, between(0.1, 2.8));
  visit("heading_rad", camera.heading_rad);
  visit("height_m", camera.height_m, above(0.0));
  visit("rate_hz", camera.rate_hz, above(0.0));
  visit("depth", camera.depth);
}

template <class Visitor>
void describe(Visitor& visit, Vehicle& vehicle) {
  visit("name", vehicle.name, identifier());
  visit("model", vehicle.model, identifier());
  visit("assumed_radius_m", vehicle.assumed_radius_m, above(0.0));
  visit("body_radius_m", vehicle.body_radius_m, above(0.0));
  visit("preferred_speed_mps", vehicle.preferred_speed_mps, above(0.0));
  visit("top_speed_mps", vehicle.top_speed_mps, above(0.0));
  visit("height_m", vehicle.height_m, above(0.0));
  visit("max_acceleration_mps2", vehicle.max_acceleration_mps2, above(0.0));
  visit("shielded", vehicle.shielded);
  visit("start", vehicle.start);
  visit("lidar", vehicle.lidar);
  visit("cameras", vehicle.cameras);
  visit("localised_by", vehicle.localised_by, oneOf({"mocap", "odometry"}));
}

template <class Visitor>
void describe(Visitor& visit, Orca& orca) {
  visit("time_horizon_s", orca.time_horizon_s, above(0.0));
  visit("obstacle_horizon_s", orca.obstacle_horizon_s, above(0.0));
  visit("radius_factor", orca.radius_factor, above(0.0));
  visit("max_heading_change_rad", orca.max_heading_change_rad, above(0.0));
  visit("time_step_s", orca.time_step_s, above(0.0));
  visit("max_neighbours", orca.max_neighbours, atLeast(0.0));
  visit("right_bias_rad", orca.right_bias_rad, atLeast(0.0));
}

template <class Visitor>
void describe(Visitor& visit, Planner& planner) {
  visit("policy", planner.policy);
  visit("rate_hz", planner.rate_hz, above(0.0));
  visit("slow_down_distance_m", planner.slow_down_distance_m, above(0.0));
  visit("hold_distance_m", planner.hold_distance_m, above(0.0));
  visit("command_valid_s", planner.command_valid_s, above(0.0));
  visit("heading_gain_per_s", planner.heading_gain_per_s, atLeast(0.0));
  visit("watch_wall_clock", planner.watch_wall_clock);
  visit("others", planner.others, oneOf({"states", "tracks", "both"}));
  visit("standing_speed_mps", planner.standing_speed_mps, atLeast(0.0));
  visit("orca", planner.orca);
}

template <class Visitor>
void describe(Visitor& visit, MotionBounds& bounds) {
  visit("delay_s", bounds.delay_s, between(0.0, 1.0));
  visit("lag_s", bounds.lag_s, between(0.0, 2.0));
  visit("inner_lag_s", bounds.inner_lag_s, between(0.0, 1.0));
  visit("max_turn_rate_radps", bounds.max_turn_rate_radps, above(0.0));
  visit("position_gain_per_s", bounds.position_gain_per_s, above(0.0));
  visit("position_speed_mps", bounds.position_speed_mps, above(0.0));
}

template <class Visitor>
void describe(Visitor& visit, Shield& shield) {
  visit("on", shield.on);
  visit("margin_m", shield.margin_m, atLeast(0.0));
  visit("unshielded_margin_m", shield.unshielded_margin_m, atLeast(0.0));
  visit("height_separation_m", shield.height_separation_m, above(0.0));
  visit("look_ahead_s", shield.look_ahead_s, atLeast(0.0));
  visit("breaker", shield.breaker);
  visit("steps_aside", shield.steps_aside);
  visit("multirotor", shield.multirotor);
  visit("unicycle", shield.unicycle);
  visit("ground_robot", shield.ground_robot);
}

template <class Visitor>
void describe(Visitor& visit, Safety& safety) {
  visit("states_hold_s", safety.states_hold_s, above(0.0));
  visit("states_land_s", safety.states_land_s, above(0.0));
  visit("own_track_hold_s", safety.own_track_hold_s, above(0.0));
  visit("own_track_land_s", safety.own_track_land_s, above(0.0));
  visit("other_track_lost_s", safety.other_track_lost_s, above(0.0));
  visit("other_track_hold_radius_m", safety.other_track_hold_radius_m, atLeast(0.0));
  visit("tracks_hold_s", safety.tracks_hold_s, above(0.0));
  visit("jump_margin_m", safety.jump_margin_m, atLeast(0.0));
  visit("max_rejects_in_a_row", safety.max_rejects_in_a_row, atLeast(1.0));
  visit("room_land_margin_m", safety.room_land_margin_m, atLeast(0.0));
  visit("airborne_height_m", safety.airborne_height_m, above(0.0));
  visit("goal_margin_m", safety.goal_margin_m, atLeast(0.0));
}

template <class Visitor>
void describe(Visitor& visit, Fleet& fleet) {
  visit("rate_hz", fleet.rate_hz, above(0.0));
  visit("assignment", fleet.assignment, oneOf({"random", "optimal", "in_order"}));
  visit("goal_repeat_s", fleet.goal_repeat_s, above(0.0));
  visit("at_goal_distance_m", fleet.at_goal_distance_m, above(0.0));
  visit("at_goal_speed_mps", fleet.at_goal_speed_mps, above(0.0));
  visit("hold_s", fleet.hold_s, atLeast(0.0));
  visit("step_timeout_s", fleet.step_timeout_s, above(0.0));
  visit("letter_height_m", fleet.letter_height_m, above(0.0));
  visit("letter_centre_m", fleet.letter_centre_m);
}

template <class Visitor>
void describe(Visitor& visit, UnicycleModel& unicycle) {
  visit("max_turn_rate_radps", unicycle.max_turn_rate_radps, above(0.0));
}

template <class Visitor>
void describe(Visitor& visit, MultirotorModel& multirotor) {
  visit("attitude_time_constant_s", multirotor.attitude_time_constant_s, above(0.0));
  visit("max_tilt_rad", multirotor.max_tilt_rad, between(0.01, 1.5));
  visit("max_acceleration_mps2", multirotor.max_acceleration_mps2, above(0.0));
  visit("max_jerk_mps3", multirotor.max_jerk_mps3, above(0.0));
  visit("velocity_gain_per_s", multirotor.velocity_gain_per_s, above(0.0));
  visit("position_gain_per_s", multirotor.position_gain_per_s, above(0.0));
  visit("max_position_speed_mps", multirotor.max_position_speed_mps, above(0.0));
  visit("max_climb_mps", multirotor.max_climb_mps, above(0.0));
  visit("max_descend_mps", multirotor.max_descend_mps, above(0.0));
  visit("max_yaw_rate_radps", multirotor.max_yaw_rate_radps, above(0.0));
  visit("yaw_gain_per_s", multirotor.yaw_gain_per_s, above(0.0));
  visit("drag_per_s", multirotor.drag_per_s, atLeast(0.0));
  visit("command_delay_s", multirotor.command_delay_s, atLeast(0.0));
}

template <class Visitor>
void describe(Visitor& visit, OdometryModel& odometry) {
  visit("rate_hz", odometry.rate_hz, above(0.0));
  visit("wheel_error", odometry.wheel_error, between(0.0, 0.2));
  visit("slip_m", odometry.slip_m, between(0.0, 1.0));
}

template <class Visitor>
void describe(Visitor& visit, GroundRobotModel& robot) {
  visit("wheel_base_m", robot.wheel_base_m, above(0.0));
  visit("max_wheel_speed_mps", robot.max_wheel_speed_mps, above(0.0));
  visit("max_wheel_acceleration_mps2", robot.max_wheel_acceleration_mps2, above(0.0));
  visit("wheel_time_constant_s", robot.wheel_time_constant_s, above(0.0));
  visit("max_turn_rate_radps", robot.max_turn_rate_radps, above(0.0));
  visit("heading_gain_per_s", robot.heading_gain_per_s, above(0.0));
  visit("position_gain_per_s", robot.position_gain_per_s, above(0.0));
  visit("max_position_speed_mps", robot.max_position_speed_mps, above(0.0));
  visit("command_delay_s", robot.command_delay_s, atLeast(0.0));
  visit("odometry", robot.odometry);
}

template <class Visitor>
void describe(Visitor& visit, MocapFault& fault) {
  visit("probability_per_s", fault.probability_per_s, atLeast(0.0));
  visit("duration_s", fault.duration_s, above(0.0));
}

template <class Visitor>
void describe(Visitor& visit, MocapModel& mocap) {
  visit("rate_hz", mocap.rate_hz, between(5.0, 1000.0));  // core::FrameGate passes no slower one
  visit("position_noise_m", mocap.position_noise_m, atLeast(0.0));
  visit("orientation_noise_rad", mocap.orientation_noise_rad, atLeast(0.0));
  visit("latency_s", mocap.latency_s, between(0.0, 1.0));
  visit("velocity_filter_s", mocap.velocity_filter_s, atLeast(0.0));
  visit("dropout", mocap.dropout);
  visit("flip", mocap.flip);
  visit("swap", mocap.swap);
}

template <class Visitor>
void describe(Visitor& visit, Area& area) {
  visit("min_m", area.min_m);
  visit("max_m", area.max_m);
}

template <class Visitor>
void describe(Visitor& visit, Push& push) {
  visit("vehicle", push.vehicle, identifier());
  visit("at_s", push.at_s, atLeast(0.0));
  visit("duration_s", push.duration_s, above(0.0));
  visit("acceleration_mps2", push.acceleration_mps2);
}

template <class Visitor>
void describe(Visitor& visit, Clutter& clutter) {
  visit("name", clutter.name, identifier());
  visit("points_m", clutter.points_m);
  visit("bottom_m", clutter.bottom_m, atLeast(0.0));
  visit("top_m", clutter.top_m, above(0.0));
}

template <class Visitor>
void describe(Visitor& visit, Sim& sim) {
  visit("pacing", sim.pacing, oneOf({"lockstep", "real_time"}));
  // A finer one is no physics: it only makes the simulator slow, and its memory large.
  visit("step_s", sim.step_s, between(1e-4, 1.0));
  visit("max_duration_s", sim.max_duration_s, above(0.0));
  visit("lockstep_patience_s", sim.lockstep_patience_s, above(0.0));
  visit("lockstep_start_s", sim.lockstep_start_s, above(0.0));
  visit("lockstep_max_factor", sim.lockstep_max_factor, above(0.0));
  visit("start_spacing_m", sim.start_spacing_m, above(0.0));
  visit("start_area", sim.start_area);
  visit("unicycle", sim.unicycle);
  visit("multirotor", sim.multirotor);
  visit("ground_robot", sim.ground_robot);
  visit("mocap", sim.mocap);
  visit("command_hold_s", sim.command_hold_s, above(0.0));
  visit("command_land_s", sim.command_land_s, above(0.0));
  visit("pushes", sim.pushes);
  visit("clutter", sim.clutter);
}

template <class Visitor>
void describe(Visitor& visit, Recording& recording) {
  visit("file", recording.file);
  visit("start_s", recording.start_s, atLeast(0.0));
  visit("frames_per_s", recording.frames_per_s, above(0.0));
}

template <class Visitor>
void describe(Visitor& visit, Pedestrians& people) {
  visit("count", people.count, between(0.0, 200.0));
  visit("policy", people.policy);
  visit("area", people.area);
  visit("preferred_speed_mps", people.preferred_speed_mps, above(0.0));
  visit("speed_deviation_mps", people.speed_deviation_mps, atLeast(0.0));
  visit("standing_share", people.standing_share, between(0.0, 1.0));
  visit("role_change_s", people.role_change_s, atLeast(0.0));
  visit("least_cooperation", people.least_cooperation, between(0.0, 1.0));
  visit("clear_of_vehicles_m", people.clear_of_vehicles_m, atLeast(0.0));
  visit("body_radius_m", people.body_radius_m, above(0.0));
  visit("leg_radius_m", people.leg_radius_m, above(0.0));
  visit("height_m", people.height_m, above(0.0));
  visit("recording", people.recording);
}

template <class Visitor>
void describe(Visitor& visit, MocapBody& body) {
  visit("vehicle", body.vehicle, identifier());
  visit("body", body.body);
  visit("id", body.id);
  visit("offset_m", body.offset_m);
  visit("rotation_rad", body.rotation_rad);
}

template <class Visitor>
void describe(Visitor& visit, MocapFilter& filter) {
  visit("position_noise_m", filter.position_noise_m, between(1e-6, 0.1));
  visit("orientation_noise_rad", filter.orientation_noise_rad, between(1e-6, 0.5));
  visit("jerk_mps3", filter.jerk_mps3, above(0.0));
  visit("angular_acceleration_radps2", filter.angular_acceleration_radps2, above(0.0));
  visit("max_turn_rate_radps", filter.max_turn_rate_radps, above(0.0));
  visit("max_residual_m", filter.max_residual_m, above(0.0));
  visit("coast_s", filter.coast_s, between(0.0, 1.0));
  visit("reacquire_s", filter.reacquire_s, between(0.0, 1.0));
}

/// Protocols that mocap_bridge speaks.
#define ROUNDABOUT_NAME_OF(protocol) #protocol,
inline const std::vector<std::string> kMocapProtocols = {
    ROUNDABOUT_MOCAP_PROTOCOLS(ROUNDABOUT_NAME_OF)};
#undef ROUNDABOUT_NAME_OF

template <class Visitor>
void describe(Visitor& visit, Mocap& mocap) {
  visit("server", mocap.server);
  visit("interface", mocap.interface);
  visit("command_port", mocap.command_port, between(0.0, 65535.0));
  visit("data_port", mocap.data_port, between(0.0, 65535.0));
  visit("group", mocap.group);
  visit("transport", mocap.transport, oneOf({"auto", "multicast", "unicast"}));
  visit("protocol", mocap.protocol, oneOf(kMocapProtocols));
  visit("version", mocap.version);
  visit("file", mocap.file);
  visit("speed", mocap.speed, atLeast(0.0));
  visit("axes", mocap.axes);
  visit("rotation", mocap.rotation, oneOf({"xyz", "zyx", "vector"}));
  visit("scale", mocap.scale, above(0.0));
  visit("latency_s", mocap.latency_s, between(0.0, 1.0));
  visit("rate_hz", mocap.rate_hz, between(0.0, 2000.0));
  visit("accept_recorded", mocap.accept_recorded);
  visit("output", mocap.output, oneOf({"camera", "resampled"}));
  visit("output_rate_hz", mocap.output_rate_hz, between(10.0, 1000.0));
  visit("filter", mocap.filter);
  visit("bodies", mocap.bodies);
}

template <class Visitor>
void describe(Visitor& visit, DetectorNetwork& network) {
  visit("input_px", network.input_px);
  visit("mean", network.mean);
  visit("scale", network.scale, above(0.0));
  visit("red_first", network.red_first);
  visit("person_class", network.person_class, between(0.0, 10'000.0));
}

template <class Visitor>
void describe(Visitor& visit, Perception& perception) {
  visit("clusterer", perception.clusterer, oneOf({"breakpoints", "dynamic_means"}));
  visit("range_noise_m", perception.range_noise_m, between(0.0, 0.2));
  visit("max_range_m", perception.max_range_m, above(0.0));
  visit("widest_body_m", perception.widest_body_m, between(0.3, 3.0));
  visit("person_radius_m", perception.person_radius_m, between(0.1, 1.0));
  visit("least_radius_m", perception.least_radius_m, between(0.01, 1.0));
  visit("acceleration_density", perception.acceleration_density, above(0.0));
  visit("lost_s", perception.lost_s, between(0.05, 10.0));
  visit("hidden_s", perception.hidden_s, between(0.05, 60.0));
  visit("map_resolution_m", perception.map_resolution_m, between(0.01, 1.0));
  visit("map_rate_hz", perception.map_rate_hz, above(0.0));
  visit("map_publish_hz", perception.map_publish_hz, above(0.0));
  visit("map_file", perception.map_file);
  visit("detector", perception.detector);
  visit("detector_confidence", perception.detector_confidence, between(0.0, 1.0));
  visit("network", perception.network);
  visit("image_period_s", perception.image_period_s, between(0.001, 60.0));
  visit("image_delay_s", perception.image_delay_s, between(0.0, 5.0));
  visit("depth_lowest_m", perception.depth_lowest_m, between(0.01, 10.0));
  visit("depth_highest_m", perception.depth_highest_m, between(0.02, 10.0));
}

template <class Visitor>
void describe(Visitor& visit, NamedPoints& named) {
  visit("name", named.name);
  visit("points_m", named.points_m, heightOptional());
}

inline const std::vector<std::string> kMissionVerbs = {"take_off", "spell", "formation",  "go_to",
                                                       "hold",     "wait",  "wait_until", "land"};
/// What wait_until waits for, where it is no time.
inline const std::vector<std::string> kMissionEvents = {"formed", "go_on"};

/// A go_to's point until it is read.
inline const Eigen::Vector3d kNoPoint =
    Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

/// The keys below a step's verb; none for take_off, hold and land, nor for wait_until, which is one
/// word or number.
template <class Visitor>
void describeArguments(Visitor& visit, MissionStep& step) {
  if (step.verb == "spell") {
    visit("text", step.text);
    visit("seconds", step.seconds, durationOrAbsent());
  } else if (step.verb == "formation") {
    visit("name", step.text);
    visit("points", step.points_m, heightOptional());
    visit("points_file", step.points_file, inputOnly());
    visit("seconds", step.seconds, durationOrAbsent());
  } else if (step.verb == "go_to") {
    step.points_m.resize(1, kNoPoint);
    visit("vehicle", step.vehicle, identifier());
    visit("point", step.points_m.front(), heightOptional());
  } else if (step.verb == "wait") {
    visit("seconds", step.seconds, durationOrAbsent());
  }
}

/// Who can publish VEHICLE_STATES: the simulator, or mocap_bridge with one of its sources.
inline const std::vector<std::string> kSources = {"sim",  "natnet",    "qualisys",
                                                  "vrpn", "vicon_udp", "replay"};

template <class Visitor>
void describe(Visitor& visit, Experiment& experiment) {
  // Filled first, then what each element of `vehicles` starts from.
  Vehicle vehicle_defaults;
  visit("name", experiment.name);
  visit("seed", experiment.seed);
  visit("source", experiment.source, oneOf(kSources));
  visit("lcm_url", experiment.lcm_url);
  visit("room", experiment.room);
  visit("obstacles", experiment.obstacles);
  visit("no_fly_zones", experiment.no_fly_zones);
  visit("vehicle_defaults", vehicle_defaults, inputOnly());
  visit("vehicles", experiment.vehicles, vehicle_defaults);
  visit("planner", experiment.planner);
  visit("shield", experiment.shield);
  visit("safety", experiment.safety);
  visit("fleet", experiment.fleet);
  visit("sim", experiment.sim);
  visit("pedestrians", experiment.pedestrians);
  visit("mocap", experiment.mocap);
  visit("perception", experiment.perception);
  visit("glyphs", experiment.glyphs);
  visit("mission", experiment.mission);
}

}  // namespace roundabout::config
