#pragma once

// All configuration of an experiment as plain structs. The YAML keys are the member names; how a
// file becomes these structs is in experiment_file.h. Units are in the names; frames are DESIGN's:
// world z up, metres.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace roundabout::config {

/// The volume vehicles may use, world frame.
struct Room {
  Eigen::Vector3d min_m{-10.0, -10.0, 0.0};
  Eigen::Vector3d max_m{10.0, 10.0, 4.0};
};

struct Start {
  Eigen::Vector2d position_m{0.0, 0.0};
  double heading_rad = 0.0;
};

/// A planar range finder in the middle of a vehicle, looking forward. The simulator's sweeps; a
/// real one's geometry comes with its messages.
struct Lidar {
  int beams = 512;  ///< the first and the last are at the edges of the field of view
  double field_of_view_rad = 3.141592653589793;
  double max_range_m = 6.0;  ///< what a beam says that hits nothing
  double rate_hz = 40.0;
  double noise_m = 0.0;          ///< standard deviation of a range
  bool sees_room_walls = false;  ///< the edges of the room are walls: for simulator and planner
  double missed_share = 0.0;     ///< of the beams that hit something and say that they did not
  double mixed_share = 0.0;      ///< of the beams at an edge in depth: a range between the two
  double sweep_s = 0.0;          ///< from the first beam to the last; a scan's utime is the last's
};

/// How a camera measures depth: along its optical axis, in whole millimetres.
struct DepthSensing {
  double nearest_m = 0.3;      ///< nothing nearer is measured
  double farthest_m = 4.0;     ///< and nothing farther
  double noise_per_m = 0.002;  ///< standard deviation of a depth, divided by the depth's square
  double missed_share = 0.0;   ///< of the pixels that see something and say nothing
};

/// A camera on a vehicle. Its image plane is upright; undistorted.
struct Camera {
  std::string name = "front";      ///< letters, digits and underscore; its own on the vehicle
  int width = 320;                 ///< pixels
  int height = 240;                ///< pixels
  double field_of_view_rad = 1.2;  ///< horizontal
  double heading_rad = 0.0;        ///< from the vehicle's, counter-clockwise
  double height_m = 0.5;           ///< of the lens above the floor
  double rate_hz = 5.0;
  std::optional<DepthSensing> depth;  ///< nothing: its pictures are in colour
};

struct Vehicle {
  std::string name;                    ///< letters, digits and underscore
  std::string model = "multirotor";    ///< entry of the simulator's table of dynamics
  double assumed_radius_m = 0.5;       ///< what policies see
  double body_radius_m = 0.35;         ///< what collides
  double preferred_speed_mps = 0.5;    ///< what the policy flies at when alone
  double top_speed_mps = 2.0;          ///< no honest measurement moves faster than this
  double height_m = 1.0;               ///< of flight, above the floor
  double max_acceleration_mps2 = 3.0;  ///< it can brake with this
  std::optional<Start> start;          ///< nothing: placed at random (sim.start_area)
  bool shielded = true;        ///< its planner flies behind a shield; others count on what it says
  std::optional<Lidar> lidar;  ///< nothing: it has none
  std::vector<Camera> cameras;
  /// Whose word its entry in VEHICLE_STATES is: the cameras' (mocap), or its wheels' (odometry).
  std::string localised_by = "mocap";
};

/// False for models that stay on the floor: they need no take-off, and landing is stopping.
inline bool flies(const Vehicle& vehicle) {
  return vehicle.model != "unicycle" && vehicle.model != "ground_robot";
}

struct UnicycleModel {
  double max_turn_rate_radps = 1e9;  ///< the published rules have no limit
};

/// A multirotor with its on-board velocity and position controllers; see sim/dynamics/multirotor.
struct MultirotorModel {
  double attitude_time_constant_s = 0.15;  ///< first-order lag of the attitude loop
  double max_tilt_rad = 0.35;
  double max_acceleration_mps2 = 3.0;  ///< horizontal and vertical
  double max_jerk_mps3 = 30.0;
  double velocity_gain_per_s = 3.0;     ///< velocity error to acceleration
  double position_gain_per_s = 1.2;     ///< position error to velocity
  double max_position_speed_mps = 1.0;  ///< horizontal speed limit of the position controller
  double max_climb_mps = 0.7;
  double max_descend_mps = 0.5;
  double max_yaw_rate_radps = 2.0;
  double yaw_gain_per_s = 3.0;
  double drag_per_s = 0.1;        ///< linear, acts on velocity
  double command_delay_s = 0.02;  ///< radio and autopilot input, command to first effect
};

/// Dead reckoning by two wheels.
struct OdometryModel {
  double rate_hz = 50.0;
  double wheel_error = 0.001;  ///< standard deviation of each wheel's constant relative error
  double slip_m = 0.001;       ///< standard deviation of a wheel's random error after 1 m
};

/// A robot on two driven wheels and a castor; see sim/dynamics/ground_robot.
struct GroundRobotModel {
  double wheel_base_m = 0.35;        ///< between the wheels
  double max_wheel_speed_mps = 2.5;  ///< of the rims
  double max_wheel_acceleration_mps2 = 3.0;
  double wheel_time_constant_s = 0.05;  ///< first-order lag of the wheels' speed controllers
  double max_turn_rate_radps = 2.5;
  double heading_gain_per_s = 4.0;   ///< heading error to turn rate
  double position_gain_per_s = 1.2;  ///< position error to speed
  double max_position_speed_mps = 0.8;
  double command_delay_s = 0.02;  ///< command to first effect
  OdometryModel odometry;
};

/// Something that goes wrong at random, for a while.
struct MocapFault {
  double probability_per_s = 0.0;  ///< rate at which it begins
  double duration_s = 0.1;         ///< mean, exponentially distributed
};

/// What the cameras add to the truth.
struct MocapModel {
  double rate_hz = 200.0;
  double position_noise_m = 0.0002;  ///< standard deviation per axis
  double orientation_noise_rad = 0.002;
  double latency_s = 0.005;         ///< exposure to message
  double velocity_filter_s = 0.02;  ///< time constant of the velocity estimate from noisy positions
  MocapFault dropout;               ///< of each vehicle: not seen
  MocapFault flip;                  ///< of each vehicle: seen the wrong way round
  MocapFault swap;                  ///< of the fleet: two vehicles are taken for each other
};

struct Area {
  Eigen::Vector2d min_m{-4.0, -4.0};
  Eigen::Vector2d max_m{4.0, 4.0};
};

/// A push that the simulator gives a vehicle, for fault experiments.
struct Push {
  std::string vehicle;
  double at_s = 0.0;  ///< after the first frame
  double duration_s = 0.5;
  Eigen::Vector2d acceleration_mps2{0.0, 0.0};  ///< added to the vehicle's, world frame
};

/// What stands or hangs in the simulator's room, and no vehicle is told of: a prism.
struct Clutter {
  std::string name;                       ///< letters, digits and underscore
  std::vector<Eigen::Vector2d> points_m;  ///< corners of a simple polygon; world
  double bottom_m = 0.0;                  ///< above the floor
  double top_m = 0.2;                     ///< above the floor
};

struct Sim {
  std::string pacing = "lockstep";  ///< lockstep or real_time
  double step_s = 0.005;            ///< of the physics; divides the frame interval
  double max_duration_s = 600.0;    ///< data time after which the simulator ends
  double lockstep_patience_s =
      2.0;  ///< wall clock; who has not answered by then is not waited for any more
  double lockstep_start_s =
      30.0;  ///< wall clock; how long to wait for everybody before the first frame
  double lockstep_max_factor = 25.0;  ///< times real time, at most: lcm-logger has to keep up
  double start_spacing_m = 1.5;       ///< smallest distance between random starting places
  Area start_area;                    ///< where random starting places lie
  UnicycleModel unicycle;
  MultirotorModel multirotor;
  GroundRobotModel ground_robot;
  MocapModel mocap;
  double command_hold_s =
      0.3;  ///< without a valid command for this long the vehicle holds by itself
  double command_land_s = 1.0;  ///< and for this long it lands by itself
  std::vector<Push> pushes;
  std::vector<Clutter> clutter;
};

struct Orca {
  double time_horizon_s = 5.0;
  double obstacle_horizon_s = 2.0;  ///< the same for obstacles; they do not move
  double radius_factor = 1.05;      ///< applied to every radius
  double max_heading_change_rad =
      3.2;  ///< above this it turns in place; pi/6 under the published rules
  double time_step_s = 0.1;
  int max_neighbours = 19;
  double right_bias_rad =
      0.4;  ///< who cannot go straight prefers this far to the right; published: 0
};

struct Planner {
  std::string policy = "orca";  ///< NAME or NAME:WEIGHTS
  double rate_hz = 10.0;
  double slow_down_distance_m =
      2.0;  ///< speed and heading change shrink linearly within this distance to the goal
  double hold_distance_m = 0.3;  ///< position control on the goal within this distance
  double command_valid_s = 0.3;
  double heading_gain_per_s = 2.0;  ///< heading-rate feed-forward
  bool watch_wall_clock = true;     ///< off for replay at any speed: only data time counts
  /// Where others are known from: VEHICLE_STATES (states), the vehicle's own perception (tracks),
  /// or both.
  std::string others = "states";
  double standing_speed_mps = 0.2;  ///< tracks that are slower stand
  Orca orca;
};

/// DESIGN section 6.
struct Safety {
  double states_hold_s = 0.15;  ///< no new vehicle states
  double states_land_s = 0.5;
  double own_track_hold_s = 0.15;  ///< own vehicle not tracked
  double own_track_land_s = 0.5;
  double other_track_lost_s =
      1.0;  ///< another vehicle not tracked: those within other_track_hold_radius_m hold
  double other_track_hold_radius_m = 2.0;
  double tracks_hold_s = 0.3;       ///< perception silent or blind: who drives by it holds
  double jump_margin_m = 0.15;      ///< measured jump beyond top speed x dt + this is rejected
  int max_rejects_in_a_row = 10;    ///< then the track is lost
  double room_land_margin_m = 0.5;  ///< farther than this outside the room: land
  double airborne_height_m = 0.15;  ///< a flying vehicle above this is in the air
  double goal_margin_m =
      0.1;  ///< goals closer than the sum of the assumed radii + this are refused
};

/// How a model follows its commands. Every number an upper bound: what it predicts must hold for
/// the slowest vehicle on the worst day.
struct MotionBounds {
  double delay_s = 0.1;       ///< from the time of the frame that is answered to the first effect
  double lag_s = 0.35;        ///< velocity error / acceleration
  double inner_lag_s = 0.15;  ///< of the acceleration behind the wanted one: the attitude's
  double max_turn_rate_radps = 1e9;  ///< of what drives along its heading; 1e9: it need not turn
  double position_gain_per_s = 1.2;  ///< of POSITION commands: distance to speed
  double position_speed_mps = 1.0;   ///< and the speed it flies at most
};

/// What stands between a policy and the vehicle; docs/shield.md.
struct Shield {
  bool on = true;
  double margin_m = 0.1;             ///< between bodies: noise, errors of the bounds, pushes
  double unshielded_margin_m = 0.1;  ///< more of it, to vehicles that are not shielded
  /// Vehicles whose heights differ by more than this pass each other; nothing: never.
  std::optional<double> height_separation_m;
  double look_ahead_s = 1.0;  ///< 0: none
  bool breaker = true;
  bool steps_aside = true;  ///< on the goal, when somebody has no other way
  MotionBounds multirotor;
  MotionBounds unicycle{.lag_s = 0.05, .inner_lag_s = 0.0, .position_gain_per_s = 2.0};
  MotionBounds ground_robot{.max_turn_rate_radps = 1.5};
};

struct Fleet {
  double rate_hz = 5.0;
  std::string assignment = "random";  ///< random, optimal, or in_order (point i to vehicle i)
  double goal_repeat_s = 1.0;
  double at_goal_distance_m = 0.2;  ///< 3-D distance that counts as arrived
  double at_goal_speed_mps = 0.2;
  double hold_s = 2.0;           ///< stay in a formation, unless the step says otherwise
  double step_timeout_s = 60.0;  ///< data time; a formation not formed by then fails the mission
  double letter_height_m = 6.0;  ///< of spelled text, before scaling up for spacing
  Eigen::Vector2d letter_centre_m{0.0, 3.0};  ///< centre of a letter's box
};

/// Something in the room that does not move, from the floor to above all heights of flight.
struct Obstacle {
  std::string name;                       ///< letters, digits and underscore
  std::vector<Eigen::Vector2d> points_m;  ///< corners of a simple polygon, counter-clockwise; world
};

/// Which rigid body of the motion-capture system is a vehicle, and how it sits on it. A vehicle
/// without an entry is the body of its own name.
struct MocapBody {
  std::string vehicle;
  std::string body;  ///< name in the system; empty: the vehicle's, unless there is an id
  int id = -1;       ///< streaming id, for systems without names; negative: by name
  Eigen::Vector3d offset_m{0.0, 0.0, 0.0};      ///< of the vehicle's centre, in the body's axes
  Eigen::Vector3d rotation_rad{0.0, 0.0, 0.0};  ///< roll, pitch, yaw of the vehicle in the body
};

/// What is believed of vehicles' movement and of the cameras. mocap_bridge/estimation.
struct MocapFilter {
  double position_noise_m = 0.0002;           ///< standard deviation of a measurement, per axis
  double orientation_noise_rad = 0.002;       ///< the same of the attitude
  double jerk_mps3 = 30.0;                    ///< that vehicles are expected to reach
  double angular_acceleration_radps2 = 10.0;  ///< the same of turning
  double max_turn_rate_radps = 12.0;          ///< no honest measurement turns faster than this
  double max_residual_m = 0.005;  ///< fits that are worse are refused; where systems say it
  double coast_s = 0.1;           ///< without measurements for this long: lost
  double reacquire_s = 0.05;      ///< of consistent measurements before a lost body counts
};

/// The motion-capture system that mocap_bridge listens to; which protocol is `source`'s to say.
struct Mocap {
  std::string server;  ///< address or name; empty: natnet looks for one, vicon_udp takes any
  std::string
      interface;         ///< address or name of this machine's interface; empty: the routes' choice
  int command_port = 0;  ///< 0: the protocol's default
  int data_port = 0;     ///< of datagrams; 0: what the server says, else the protocol's default
  std::string group;     ///< multicast; empty: what the server says
  std::string transport = "auto";   ///< natnet: auto (what the server says), multicast or unicast
  std::string protocol = "natnet";  ///< of replay's packet file
  std::string version;              ///< of replay's packets, if none of them says it
  std::string file;                 ///< replay: packets or an LCM event log
  double speed = 1.0;               ///< replay: times real time; 0: as fast as it goes
  std::string axes = "auto";        ///< auto (the protocol's habit), y_up, z_up, or as "x,-z,y"
  std::string rotation = "xyz";     ///< vicon_udp: xyz (intrinsic), zyx or vector
  double scale = 1.0;               ///< applied to positions, beyond the protocol's unit
  double latency_s = 0.005;         ///< exposure to arrival, for systems that do not say it
  double rate_hz = 0.0;             ///< of the cameras, for systems that do not say it; 0: learn it
  bool accept_recorded = false;     ///< also publish what the system plays back (edit mode)
  std::string output = "camera";    ///< one message a camera frame, or resampled to output_rate_hz
  double output_rate_hz = 200.0;
  MocapFilter filter;
  std::vector<MocapBody> bodies;
};

/// Recorded people, in the format of the ETH data set (obsmat.txt).
struct Recording {
  std::string file;      ///< path; empty: nobody
  double start_s = 0.0;  ///< of the recording, counted from its first line, at the first frame
  double frames_per_s = 15.0;  ///< what the first column counts
};

/// People of the simulator. No process but the simulator knows of them.
struct Pedestrians {
  int count = 0;  ///< who walk about by a policy
  /// social_force, or as planner.policy.
  std::string policy = "social_force";
  Area area;  ///< in which they begin and have their goals
  double preferred_speed_mps = 1.0;
  double speed_deviation_mps = 0.15;  ///< standard deviation between people
  double standing_share = 0.0;        ///< of `count`; always so many
  double role_change_s = 0.0;         ///< mean time until two exchange roles; 0: never
  double least_cooperation = 1.0;     ///< drawn between this and 1: how much one minds vehicles
  double clear_of_vehicles_m = 1.5;   ///< nobody begins nearer to a vehicle's start
  double body_radius_m = 0.25;        ///< what collides
  double leg_radius_m = 0.06;
  double height_m = 1.75;
  Recording recording;  ///< these see nobody
};

/// Of a detector that is a file, where it differs from what is customary for its kind.
struct DetectorNetwork {
  std::optional<Eigen::Vector2d> input_px;  ///< width and height of the picture that it takes
  std::optional<Eigen::Vector3d> mean;      ///< taken from the three colours, of 255, in its order
  std::optional<double> scale;              ///< what is left is multiplied by
  std::optional<bool> red_first;            ///< the order of colours: red, green, blue
  std::optional<int> person_class;          ///< counted from 0, the background too
};

/// What a vehicle's perception makes of its scans and images; docs/perception.md.
struct Perception {
  std::string clusterer = "breakpoints";  ///< entry of perception's table of clusterers
  double range_noise_m = 0.02;            ///< standard deviation of a range, for the breakpoints
  double max_range_m = 10.0;              ///< nothing farther is followed
  double widest_body_m = 0.9;             ///< what is wider is a wall or furniture
  double person_radius_m = 0.3;           ///< of whoever walks on two legs, at least
  double least_radius_m = 0.15;           ///< of anybody else, at least
  double acceleration_density = 0.6;      ///< of the tracks' white noise, m^2/s^3
  double lost_s = 0.5;    ///< who should be seen and is not is forgotten after this time
  double hidden_s = 2.0;  ///< and who is behind somebody, or out of view, after this
  double map_resolution_m = 0.05;
  double map_rate_hz = 10.0;  ///< scans put into the map
  double map_publish_hz = 1.0;
  std::string map_file;              ///< path of a .bt file that is saved at the end; empty: none
  std::string detector = "hog";      ///< of people in images: hog, none, or the path of a model
  double detector_confidence = 0.5;  ///< boxes below are no people
  DetectorNetwork network;
  double image_period_s = 0.2;   ///< of each camera; images between are not looked at
  double image_delay_s = 0.3;    ///< boxes and depths count from so long after the exposure
  double depth_lowest_m = 0.06;  ///< what depth cameras see between this height above the floor
  double depth_highest_m = 0.8;  ///< and this one stands in the way
};

struct NamedPoints {
  std::string name;
  std::vector<Eigen::Vector3d> points_m;
};

/// One step of a mission. Exactly one of the verbs of lcmtypes/mission_t.lcm.
struct MissionStep {
  std::string verb;
  std::string text;                       ///< spell: what; formation: its name; wait_until: event
  std::string vehicle;                    ///< go_to
  std::vector<Eigen::Vector3d> points_m;  ///< formation, go_to; world
  double seconds = -1.0;    ///< wait, wait_until, or stay in a formation; negative: default
  std::string points_file;  ///< formation: read into points_m, then empty
};

struct Experiment {
  std::string name;
  std::uint64_t seed = 1;
  std::string source = "sim";  ///< who publishes VEHICLE_STATES
  std::string lcm_url;         ///< empty: LCM_DEFAULT_URL, else LCM's own default
  Room room;
  std::vector<Obstacle> obstacles;
  std::vector<Obstacle> no_fly_zones;  ///< nothing stands there, but nobody flies there
  std::vector<Vehicle> vehicles;
  Planner planner;
  Shield shield;
  Safety safety;
  Fleet fleet;
  Sim sim;
  Pedestrians pedestrians;
  Mocap mocap;
  Perception perception;
  std::vector<NamedPoints>
      glyphs;  ///< points that replace the built-in letter for a spelled character
  std::vector<MissionStep> mission;
  std::string file;  ///< where it was read from; not a key
};

/// Whether a vehicle has a perception process: its planner wants tracks, and it has a lidar.
inline bool seesForItself(const Experiment& experiment, const Vehicle& vehicle) {
  return experiment.planner.others != "states" && vehicle.lidar.has_value();
}

}  // namespace roundabout::config
