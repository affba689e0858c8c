#include "common/config/checks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/config/depth_age.h"
#include "common/config/mapped_body.h"
#include "common/config/obstacles.h"
#include "common/config/spacing.h"
#include "common/config/words.h"
#include "common/core/sensor_data.h"

namespace roundabout::config {

namespace {

const Vehicle* findVehicle(const Experiment& experiment, const std::string& name) {
  const auto found = std::find_if(experiment.vehicles.begin(), experiment.vehicles.end(),
                                  [&](const Vehicle& vehicle) { return vehicle.name == name; });
  return found == experiment.vehicles.end() ? nullptr : &*found;
}

void expectVehicle(const Experiment& experiment, const std::string& path, const std::string& name,
                   const Refuse& refuse) {
  if (findVehicle(experiment, name) == nullptr) {
    std::vector<std::string> names;
    for (const Vehicle& vehicle : experiment.vehicles) {
      names.push_back(vehicle.name);
    }
    refuse(path, fmt::format("a vehicle ({})", fmt::join(names, ", ")), inQuotes(name));
  }
}

// `later_path` must not be below `earlier_path`.
void expectOrder(const std::string& later_path, double later, const std::string& earlier_path,
                 double earlier, const Refuse& refuse) {
  if (later < earlier) {
    refuse(later_path, fmt::format("at least {} ({})", earlier_path, earlier),
           fmt::format("{}", later));
  }
}

template <class Corners>
void expectCorners(const std::string& path, const Corners& box, const Refuse& refuse) {
  if (!(box.min_m.array() < box.max_m.array()).all()) {
    refuse(path + ".max_m", "every coordinate above min_m's",
           fmt::format("[{}]",
                       fmt::join(box.max_m.data(), box.max_m.data() + box.max_m.size(), ", ")));
  }
}

// A body of this radius must fit between the place and the walls.
void expectInRoom(const std::string& path, const Room& room, const Eigen::Vector2d& place_m,
                  double body_radius_m, const Refuse& refuse) {
  const bool inside = (place_m.array() - body_radius_m >= room.min_m.head<2>().array()).all() &&
                      (place_m.array() + body_radius_m <= room.max_m.head<2>().array()).all();
  if (!inside) {
    refuse(
        path,
        fmt::format("a place in the room (x {} to {}, y {} to {}) less a body radius of {} m",
                    room.min_m.x(), room.max_m.x(), room.min_m.y(), room.max_m.y(), body_radius_m),
        fmt::format("[{}, {}]", place_m.x(), place_m.y()));
  }
}

void checkRoom(const Experiment& experiment, const Refuse& refuse) {
  expectCorners("room", experiment.room, refuse);
  if (experiment.room.min_m.z() != 0.0) {
    refuse("room.min_m", "z = 0, since the floor is where z is 0",
           fmt::format("z = {}", experiment.room.min_m.z()));
  }
}

void checkStartArea(const Experiment& experiment, const Refuse& refuse) {
  const Area& area = experiment.sim.start_area;
  expectCorners("sim.start_area", area, refuse);
  // In a lab the vehicles stand where they stand.
  const bool used = experiment.source == "sim" &&
                    std::any_of(experiment.vehicles.begin(), experiment.vehicles.end(),
                                [](const Vehicle& vehicle) { return !vehicle.start; });
  if (!used) {
    return;
  }
  const double body_radius_m = largestBodyRadiusM(experiment);
  expectInRoom("sim.start_area.min_m", experiment.room, area.min_m, body_radius_m, refuse);
  expectInRoom("sim.start_area.max_m", experiment.room, area.max_m, body_radius_m, refuse);
  const double spacing_m = goalSpacingM(experiment);
  if (experiment.sim.start_spacing_m < spacing_m) {
    refuse("sim.start_spacing_m",
           fmt::format("at least {} (two assumed radii and safety.goal_margin_m)", spacing_m),
           fmt::format("{}", experiment.sim.start_spacing_m));
  }
}

void checkStart(const Experiment& experiment, std::size_t i, const Refuse& refuse) {
  const Vehicle& vehicle = experiment.vehicles[i];
  if (!vehicle.start) {
    return;
  }
  const std::string path = fmt::format("vehicles[{}].start.position_m", i);
  expectInRoom(path, experiment.room, vehicle.start->position_m, vehicle.body_radius_m, refuse);
  for (std::size_t j = 0; j < i; ++j) {
    const Vehicle& other = experiment.vehicles[j];
    if (!other.start) {
      continue;
    }
    constexpr double kRounding_m = 1e-9;
    const double distance_m = (vehicle.start->position_m - other.start->position_m).norm();
    const double spacing_m = goalSpacingM(experiment);
    if (distance_m < spacing_m - kRounding_m) {
      refuse(path,
             fmt::format("at least {} m (two assumed radii and safety.goal_margin_m) from "
                         "vehicles[{}] \"{}\"",
                         spacing_m, j, other.name),
             fmt::format("{:.3f} m", distance_m));
    }
  }
}

/// How far a vehicle comes, at most, between the exposure of the last depth picture in its
/// planner's map and its stop: perception says when the picture is too old, and the planner holds
/// once that has been said for long enough.
double blindWayM(const Experiment& experiment, const Vehicle& vehicle, const Camera& camera) {
  const double speed_mps = vehicle.preferred_speed_mps;
  const double driven_s = oldestDepthsS(vehicle, camera, experiment.perception) +
                          experiment.safety.tracks_hold_s + 1.0 / experiment.planner.rate_hz;
  return speed_mps * driven_s + speed_mps * speed_mps / (2.0 * vehicle.max_acceleration_mps2) +
         vehicle.body_radius_m;
}

void checkDepth(const Experiment& experiment, const Vehicle& vehicle, const Camera& camera,
                const std::string& path, const Refuse& refuse) {
  constexpr int kMostBytes = 60'000;  // bus::kMostImageBytes
  if (!camera.depth) {
    return;
  }
  if (flies(vehicle)) {
    refuse(path + ".depth", "a vehicle that drives: the lens's height is taken as it is",
           vehicle.model);
  }
  if (!seesForItself(experiment, vehicle)) {
    refuse(path + ".depth",
           vehicle.lidar ? "planner.others: tracks or both, so that perception is listened to"
                         : "a vehicle with a lidar, so that it has a perception process",
           vehicle.lidar ? experiment.planner.others : "none");
  }
  if (experiment.perception.depth_highest_m < vehicle.height_m) {
    refuse("perception.depth_highest_m",
           fmt::format("at least vehicles[].height_m ({}) of {}", vehicle.height_m, vehicle.name),
           fmt::format("{}", experiment.perception.depth_highest_m));
  }
  if (const double way_m = blindWayM(experiment, vehicle, camera);
      camera.depth->farthest_m < way_m) {
    refuse(
        path + ".depth.farthest_m",
        fmt::format("at least {:.2f}: how far {} comes until it stops for what is in a picture, or "
                    "for want of one (rate_hz, perception.image_period_s, image_delay_s, "
                    "map_rate_hz, map_publish_hz, safety.tracks_hold_s)",
                    way_m, vehicle.name),
        fmt::format("{}", camera.depth->farthest_m));
  }
  expectOrder(path + ".depth.farthest_m", camera.depth->farthest_m, "nearest_m",
              camera.depth->nearest_m, refuse);
  if (2 * camera.width * camera.height > kMostBytes) {
    refuse(path + ".width",
           fmt::format("a depth picture of at most {} bytes, two a pixel (160 x 120)", kMostBytes),
           fmt::format("{} x {}", camera.width, camera.height));
  }
}

void checkVehicle(const Experiment& experiment, std::size_t i, const Refuse& refuse) {
  const Room& room = experiment.room;
  const Vehicle& vehicle = experiment.vehicles[i];
  const std::string path = fmt::format("vehicles[{}]", i);
  if (vehicle.name.empty()) {
    refuse(path + ".name", "letters, digits and underscore", "nothing");
  }
  expectOrder(path + ".top_speed_mps", vehicle.top_speed_mps, "preferred_speed_mps",
              vehicle.preferred_speed_mps, refuse);
  if (vehicle.height_m <= room.min_m.z() || vehicle.height_m >= room.max_m.z()) {
    refuse(path + ".height_m",
           fmt::format("a height in the room ({} to {})", room.min_m.z(), room.max_m.z()),
           fmt::format("{}", vehicle.height_m));
  }
  expectOrder(path + ".assumed_radius_m", vehicle.assumed_radius_m, "body_radius_m",
              vehicle.body_radius_m, refuse);
  if (vehicle.lidar && vehicle.lidar->sweep_s > 1.0 / vehicle.lidar->rate_hz) {
    refuse(path + ".lidar.sweep_s",
           fmt::format("at most the time between sweeps ({} s)", 1.0 / vehicle.lidar->rate_hz),
           fmt::format("{}", vehicle.lidar->sweep_s));
  }
  for (std::size_t j = 0; j < vehicle.cameras.size(); ++j) {
    checkDepth(experiment, vehicle, vehicle.cameras[j], fmt::format("{}.cameras[{}]", path, j),
               refuse);
    for (std::size_t k = 0; k < j; ++k) {
      if (vehicle.cameras[j].name == vehicle.cameras[k].name) {
        refuse(fmt::format("{}.cameras[{}].name", path, j), "a name of its own",
               fmt::format("\"{}\", which is cameras[{}]'s", vehicle.cameras[j].name, k));
      }
    }
  }
  for (std::size_t j = 0; j < i; ++j) {
    const Vehicle& other = experiment.vehicles[j];
    if (other.name == vehicle.name) {
      refuse(path + ".name", "a name of its own",
             fmt::format("\"{}\", which is vehicles[{}]'s", vehicle.name, j));
    }
  }
}

void checkLimits(const Experiment& experiment, const Refuse& refuse) {
  const Safety& safety = experiment.safety;
  const Planner& planner = experiment.planner;
  const Sim& sim = experiment.sim;
  expectOrder("safety.states_land_s", safety.states_land_s, "states_hold_s", safety.states_hold_s,
              refuse);
  expectOrder("safety.own_track_land_s", safety.own_track_land_s, "own_track_hold_s",
              safety.own_track_hold_s, refuse);
  expectOrder("planner.slow_down_distance_m", planner.slow_down_distance_m, "hold_distance_m",
              planner.hold_distance_m, refuse);
  expectOrder("planner.orca.obstacle_horizon_s", planner.orca.obstacle_horizon_s, "time_step_s",
              planner.orca.time_step_s, refuse);
  expectOrder("sim.command_land_s", sim.command_land_s, "command_hold_s", sim.command_hold_s,
              refuse);
  expectOrder("sim.mocap.rate_hz", sim.mocap.rate_hz, "planner.rate_hz", planner.rate_hz, refuse);
  expectOrder("sim.mocap.rate_hz", sim.mocap.rate_hz, "fleet.rate_hz", experiment.fleet.rate_hz,
              refuse);
  const double steps = 1.0 / (sim.mocap.rate_hz * sim.step_s);
  if (std::round(steps) < 1.0 || std::abs(steps - std::round(steps)) > 1e-6 * steps) {
    refuse("sim.step_s",
           fmt::format("a whole part of the frame interval (1/{} s)", sim.mocap.rate_hz),
           fmt::format("{}", sim.step_s));
  }
  for (std::size_t i = 0; i < sim.pushes.size(); ++i) {
    expectVehicle(experiment, fmt::format("sim.pushes[{}].vehicle", i), sim.pushes[i].vehicle,
                  refuse);
  }
}

void checkPedestrians(const Experiment& experiment, const Refuse& refuse) {
  const Pedestrians& people = experiment.pedestrians;
  expectCorners("pedestrians.area", people.area, refuse);
  if (people.body_radius_m < 2.0 * people.leg_radius_m) {
    refuse("pedestrians.body_radius_m",
           fmt::format("at least two legs' radii ({})", 2.0 * people.leg_radius_m),
           fmt::format("{}", people.body_radius_m));
  }
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const Vehicle& vehicle = experiment.vehicles[i];
    if (experiment.planner.others == "tracks" && !vehicle.lidar) {
      refuse(fmt::format("vehicles[{}].lidar", i),
             "one, since planner.others is tracks and nothing else sees", "none");
    }
    if (vehicle.localised_by == "odometry" && vehicle.model != "ground_robot") {
      refuse(fmt::format("vehicles[{}].localised_by", i),
             "mocap, since only a ground_robot has wheels to count", "odometry");
    }
  }
}

void checkPerception(const Experiment& experiment, const Refuse& refuse) {
  if (const auto& input = experiment.perception.network.input_px) {
    constexpr double kMostPixels = 4096.0;
    const bool fits = *input == input->array().round().matrix() && input->minCoeff() >= 1.0 &&
                      input->maxCoeff() <= kMostPixels;
    if (!fits) {
      refuse("perception.network.input_px",
             fmt::format("[width, height], whole numbers from 1 to {}", kMostPixels),
             fmt::format("[{}, {}]", input->x(), input->y()));
    }
  }
  const std::string& detector = experiment.perception.detector;
  const DetectorNetwork& network = experiment.perception.network;
  if ((detector == "hog" || detector == "none") &&
      (network.input_px || network.mean || network.scale || network.red_first ||
       network.person_class)) {
    refuse("perception.network", "none, or a perception.detector that is the path of a network",
           "\"" + detector + "\"");
  }
  expectOrder("perception.depth_highest_m", experiment.perception.depth_highest_m, "depth_lowest_m",
              experiment.perception.depth_lowest_m, refuse);
  const bool used =
      std::any_of(experiment.vehicles.begin(), experiment.vehicles.end(),
                  [&](const Vehicle& vehicle) { return seesForItself(experiment, vehicle); });
  const Eigen::Vector2d room_m = (experiment.room.max_m - experiment.room.min_m).head<2>();
  const double finest_m = std::sqrt(room_m.prod() / core::kMostMapCells);
  if (used && experiment.perception.map_resolution_m < finest_m) {
    refuse("perception.map_resolution_m",
           fmt::format("at least {:.3f}: a map of this room has at most {:.0f} cells", finest_m,
                       core::kMostMapCells),
           fmt::format("{}", experiment.perception.map_resolution_m));
  }
}

void checkMocap(const Experiment& experiment, const Refuse& refuse) {
  const std::vector<MocapBody>& bodies = experiment.mocap.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::string path = fmt::format("mocap.bodies[{}]", i);
    expectVehicle(experiment, path + ".vehicle", bodies[i].vehicle, refuse);
    if (!bodies[i].body.empty() && bodies[i].id >= 0) {
      refuse(path, "a body or an id", "both");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (bodies[j].vehicle == bodies[i].vehicle) {
        refuse(path + ".vehicle", "one body a vehicle",
               fmt::format("\"{}\", which mocap.bodies[{}] has too", bodies[i].vehicle, j));
      }
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyKey key = bodyKeyOf(experiment.mocap, bodies[i].vehicle);
    for (const Vehicle& vehicle : experiment.vehicles) {
      const MocapBody* own = mocapBodyOf(experiment.mocap, vehicle.name);
      const bool said_later = own != nullptr && own > &bodies[i];
      if (vehicle.name != bodies[i].vehicle && !said_later &&
          bodyKeyOf(experiment.mocap, vehicle.name) == key) {
        refuse(fmt::format("mocap.bodies[{}]", i), "a body that is no other vehicle's",
               fmt::format("{}, which is {}'s", text(key), vehicle.name));
      }
    }
  }
  if (experiment.source == "replay" && experiment.mocap.file.empty()) {
    refuse("mocap.file", "the recording that source: replay plays", "nothing");
  }
  const bool needs_server = experiment.source == "qualisys" || experiment.source == "vrpn";
  if (needs_server && experiment.mocap.server.empty()) {
    refuse("mocap.server", "the address or name of the machine that serves " + experiment.source,
           "nothing");
  }
}

// A command that expires before it has an effect moves nothing: that cannot be predicted.
void checkShield(const Experiment& experiment, const Refuse& refuse) {
  const Shield& shield = experiment.shield;
  for (const auto& [model, bounds] :
       {std::pair{"multirotor", &shield.multirotor}, std::pair{"unicycle", &shield.unicycle},
        std::pair{"ground_robot", &shield.ground_robot}}) {
    const bool flown =
        std::any_of(experiment.vehicles.begin(), experiment.vehicles.end(),
                    [&of = model](const Vehicle& vehicle) { return vehicle.model == of; });
    const double needed_s = bounds->delay_s + 1.0 / experiment.planner.rate_hz;
    if (flown && experiment.planner.command_valid_s < needed_s) {
      refuse("planner.command_valid_s",
             fmt::format("at least {} (shield.{}.delay_s and a planning period)", needed_s, model),
             fmt::format("{}", experiment.planner.command_valid_s));
    }
  }
}

void expectPoints(const Experiment& experiment, const std::string& path, std::size_t count,
                  const Refuse& refuse) {
  if (count < 1 || count > experiment.vehicles.size()) {
    refuse(path, fmt::format("1 to {} points (one a vehicle at most)", experiment.vehicles.size()),
           fmt::format("{}", count));
  }
}

void checkMission(const Experiment& experiment, const Refuse& refuse) {
  for (std::size_t i = 0; i < experiment.glyphs.size(); ++i) {
    const NamedPoints& glyph = experiment.glyphs[i];
    const std::string path = fmt::format("glyphs[{}]", i);
    if (glyph.name.size() != 1) {
      refuse(path + ".name", "one character", inQuotes(glyph.name));
    }
    expectPoints(experiment, path + ".points_m", glyph.points_m.size(), refuse);
    for (std::size_t j = 0; j < i; ++j) {
      if (experiment.glyphs[j].name == glyph.name) {
        refuse(path + ".name", "a name of its own",
               fmt::format("\"{}\", which is glyphs[{}]'s", glyph.name, j));
      }
    }
  }
  for (std::size_t i = 0; i < experiment.mission.size(); ++i) {
    const MissionStep& step = experiment.mission[i];
    const std::string path = fmt::format("mission[{}].{}", i, step.verb);
    if (step.verb == "spell" && step.text.empty()) {
      refuse(path, "text to spell", "nothing");
    }
    if (step.verb == "formation") {
      expectPoints(experiment, path + ".points", step.points_m.size(), refuse);
    }
    if (step.verb == "go_to") {
      expectVehicle(experiment, path + ".vehicle", step.vehicle, refuse);
      if (step.points_m.empty() || std::isnan(step.points_m.front().x())) {
        refuse(path + ".point", "[x, y] or [x, y, z]", "nothing");
      }
    }
    if (step.verb == "wait" && step.seconds < 0.0) {
      refuse(path, "a number of at least 0", "nothing");
    }
    if (step.verb == "wait_until" && step.text.empty() && step.seconds < 0.0) {
      refuse(path, "formed, go_on, or seconds since the take-off", "nothing");
    }
  }
}

}  // namespace

void fillHeights(Experiment& experiment, const Refuse& refuse) {
  const auto fill = [&](const std::string& path, const std::vector<const Vehicle*>& flyers,
                        std::vector<Eigen::Vector3d>& points_m) {
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      if (!std::isnan(points_m[i].z()) || flyers.empty()) {
        continue;
      }
      points_m[i].z() = flyers.front()->height_m;
      for (const Vehicle* vehicle : flyers) {
        if (vehicle->height_m != points_m[i].z()) {
          refuse(fmt::format("{}[{}]", path, i), "[x, y, z], since heights of flight differ",
                 fmt::format("[{}, {}]", points_m[i].x(), points_m[i].y()));
        }
      }
    }
  };
  std::vector<const Vehicle*> all;
  for (const Vehicle& vehicle : experiment.vehicles) {
    all.push_back(&vehicle);
  }
  for (std::size_t i = 0; i < experiment.glyphs.size(); ++i) {
    fill(fmt::format("glyphs[{}].points_m", i), all, experiment.glyphs[i].points_m);
  }
  for (std::size_t i = 0; i < experiment.mission.size(); ++i) {
    MissionStep& step = experiment.mission[i];
    const Vehicle* own = findVehicle(experiment, step.vehicle);
    if (step.verb == "go_to") {
      fill(fmt::format("mission[{}].go_to.point", i),
           own == nullptr ? all : std::vector<const Vehicle*>{own}, step.points_m);
    } else {
      fill(fmt::format("mission[{}].formation.points", i), all, step.points_m);
    }
  }
}

void checkConsistency(const Experiment& experiment, const Refuse& refuse) {
  if (experiment.vehicles.empty()) {
    refuse("vehicles", "at least one vehicle", "none");
  }
  checkRoom(experiment, refuse);
  checkObstacles(experiment, refuse);
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    checkVehicle(experiment, i, refuse);
  }
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    checkStart(experiment, i, refuse);
  }
  checkStartArea(experiment, refuse);
  checkLimits(experiment, refuse);
  checkPedestrians(experiment, refuse);
  checkPerception(experiment, refuse);
  checkMocap(experiment, refuse);
  checkShield(experiment, refuse);
  checkMission(experiment, refuse);
}

}  // namespace roundabout::config
