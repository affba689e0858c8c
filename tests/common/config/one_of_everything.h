#pragma once

// An experiment in which no value is the default and every list has an element.

#include "common/config/experiment.h"

namespace roundabout::config {

inline Experiment oneOfEverything() {
  Experiment e;
  e.name = "everything";
  e.seed = 18446744073709551615ULL;
  e.source = "replay";
  e.lcm_url = "udpm://239.255.76.68:7668?ttl=0";
  e.room = {{-6.5, -5.25, 0.0}, {6.5, 5.75, 3.3}};

  e.obstacles = {{"pillar", {{5.0, 5.0}, {5.5, 5.0}, {5.5, 5.5}}}};
  e.no_fly_zones = {{"stage", {{-5.0, 5.0}, {-4.5, 5.0}, {-4.5, 5.5}}}};

  Vehicle first;
  first.name = "hex_1";
  first.assumed_radius_m = 0.45;
  first.body_radius_m = 0.1 + 0.2;  // has no short decimal form
  first.preferred_speed_mps = 1.1;
  first.top_speed_mps = 3.5;
  first.height_m = 1.25;
  first.max_acceleration_mps2 = 2.5;
  first.shielded = false;
  first.start = Start{{-1.5, 2.5}, -0.75};
  first.lidar = Lidar{360, 6.25, 4.5, 20.0, 0.01, true, 0.02, 0.5, 0.025};
  first.cameras = {{"left", 160, 120, 1.4, 0.75, 0.35, 10.0, DepthSensing{0.25, 5.0, 0.004, 0.05}}};
  first.model = "ground_robot";
  first.localised_by = "odometry";
  Vehicle second = first;
  second.name = "2";
  second.height_m = 1.75;
  second.start.reset();
  second.lidar.reset();
  second.cameras.clear();
  second.model = "unicycle";
  second.localised_by = "mocap";
  e.vehicles = {first, second};

  e.planner.policy = "ga3c_cadrl:/weights/net.safetensors";
  e.planner.rate_hz = 20.0;
  e.planner.slow_down_distance_m = 2.5;
  e.planner.hold_distance_m = 0.25;
  e.planner.command_valid_s = 0.4;
  e.planner.heading_gain_per_s = 1.5;
  e.planner.watch_wall_clock = false;
  e.planner.others = "both";
  e.planner.standing_speed_mps = 0.15;
  e.planner.orca = {4.0, 1.5, 1.2, 0.5, 0.05, 7, 0.1};

  e.shield.on = false;
  e.shield.margin_m = 0.05;
  e.shield.unshielded_margin_m = 0.2;
  e.shield.height_separation_m = 0.75;
  e.shield.look_ahead_s = 1.25;
  e.shield.breaker = false;
  e.shield.steps_aside = false;
  e.shield.multirotor = {0.15, 0.5, 0.2, 3.0, 1.5, 0.8};
  e.shield.unicycle = {0.12, 0.25, 0.1, 2.0, 1.1, 0.9};
  e.shield.ground_robot = {0.2, 0.3, 0.05, 1.75, 1.3, 0.6};

  e.safety = {0.2, 0.6, 0.25, 0.75, 1.5, 2.5, 0.35, 0.2, 12, 0.75, 0.25, 0.2};

  e.fleet.rate_hz = 4.0;
  e.fleet.assignment = "in_order";
  e.fleet.goal_repeat_s = 2.0;
  e.fleet.at_goal_distance_m = 0.15;
  e.fleet.at_goal_speed_mps = 0.1;
  e.fleet.hold_s = 3.0;
  e.fleet.step_timeout_s = 45.0;
  e.fleet.letter_height_m = 5.0;
  e.fleet.letter_centre_m = {0.5, -0.5};

  e.sim.pacing = "real_time";
  e.sim.step_s = 0.0025;
  e.sim.max_duration_s = 120.0;
  e.sim.lockstep_patience_s = 3.0;
  e.sim.lockstep_start_s = 10.0;
  e.sim.lockstep_max_factor = 50.0;
  e.sim.start_spacing_m = 1.25;
  e.sim.start_area = {{-3.0, -2.0}, {3.0, 2.0}};
  e.sim.unicycle.max_turn_rate_radps = 2.5;
  e.sim.multirotor = {0.2, 0.3, 2.0, 20.0, 2.5, 1.0, 0.8, 0.6, 0.4, 1.5, 2.0, 0.2, 0.04};
  e.sim.ground_robot = {0.5, 1.5, 2.0, 0.1, 1.5, 3.0, 1.1, 0.6, 0.03, {40.0, 0.002, 0.003}};
  e.sim.mocap = {100.0, 0.001, 0.004, 0.01, 0.03, {0.5, 0.2}, {0.1, 0.3}, {0.4, 0.6}};
  e.sim.command_hold_s = 0.35;
  e.sim.command_land_s = 1.5;
  e.sim.pushes = {{"hex_1", 3.0, 0.75, {1.0, -2.0}}};
  e.sim.clutter = {{"shelf", {{3.0, -5.0}, {3.5, -5.0}, {3.5, -4.5}}, 0.5, 0.75}};

  e.pedestrians.count = 6;
  e.pedestrians.policy = "orca";
  e.pedestrians.area = {{-2.0, -1.5}, {2.5, 1.0}};
  e.pedestrians.preferred_speed_mps = 0.9;
  e.pedestrians.speed_deviation_mps = 0.1;
  e.pedestrians.standing_share = 0.5;
  e.pedestrians.role_change_s = 6.0;
  e.pedestrians.least_cooperation = 0.25;
  e.pedestrians.clear_of_vehicles_m = 1.25;
  e.pedestrians.body_radius_m = 0.3;
  e.pedestrians.leg_radius_m = 0.07;
  e.pedestrians.height_m = 1.8;
  e.pedestrians.recording = {"/data/obsmat.txt", 30.0, 25.0};
  e.perception = {"dynamic_means", 0.01,     8.0, 1.1, 0.35, 0.2, 0.7,  0.4, 3.0, 0.1, 5.0, 0.5,
                  "m.bt",          "n.onnx", 0.6, {},  0.25, 0.4, 0.05, 1.5};
  e.perception.network.input_px.emplace(320.0, 256.0);
  e.perception.network.mean.emplace(123.0, 117.0, 104.0);
  e.perception.network.scale = 0.5;
  e.perception.network.red_first = false;
  e.perception.network.person_class = 3;

  e.mocap.server = "192.168.0.106";
  e.mocap.interface = "eth0";
  e.mocap.command_port = 1610;
  e.mocap.data_port = 1611;
  e.mocap.group = "239.255.42.98";
  e.mocap.transport = "unicast";
  e.mocap.protocol = "vrpn";
  e.mocap.version = "2.7";
  e.mocap.file = "lab.packets";
  e.mocap.speed = 2.0;
  e.mocap.axes = "z,x,y";
  e.mocap.rotation = "zyx";
  e.mocap.scale = 0.001;
  e.mocap.latency_s = 0.007;
  e.mocap.rate_hz = 120.0;
  e.mocap.accept_recorded = true;
  e.mocap.output = "resampled";
  e.mocap.output_rate_hz = 100.0;
  e.mocap.filter = {0.0003, 0.003, 40.0, 20.0, 15.0, 0.006, 0.12, 0.06};
  e.mocap.bodies = {{"hex_1", "Body 1", -1, {0.1, 0.0, -0.2}, {0.0, 0.1, 0.2}},
                    {"2", "", 17, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};

  e.glyphs = {{"#", {{0.0, 1.0, 1.5}, {1.0, 2.0, 1.25}}}};
  e.mission = {{"take_off", "", "", {}, -1.0, ""},
               {"spell", "A B: \"C\"", "", {}, 2.5, ""},
               {"formation", "pair", "", {{1.0, 2.0, 1.5}, {-1.0, 2.0, 1.0}}, -1.0, ""},
               {"go_to", "", "hex_1", {{1.0, 2.0, 1.5}}, -1.0, ""},
               {"hold", "", "", {}, -1.0, ""},
               {"wait", "", "", {}, 0.0, ""},
               {"wait_until", "formed", "", {}, -1.0, ""},
               {"wait_until", "", "", {}, 1.5, ""},
               {"land", "", "", {}, -1.0, ""}};
  return e;
}

}  // namespace roundabout::config
