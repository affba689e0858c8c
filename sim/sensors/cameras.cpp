#include "sim/sensors/cameras.h"

#include "common/config/obstacles.h"
#include "common/core/vehicle_state.h"
#include "sim/sensors/jpeg.h"

namespace roundabout::sim {

namespace {

// As high as any camera looks.
constexpr double kWithoutEnd_m = 100.0;
// Of a person's height: where legs end, and where the head begins.
constexpr double kHip = 0.48;
constexpr double kShoulder = 0.85;
constexpr double kTrunkRadius_m = 0.18;
constexpr double kHeadRadius_m = 0.09;

std::vector<Prism> prismsOf(const config::Experiment& experiment) {
  std::vector<Prism> prisms;
  for (const config::Obstacle& obstacle : experiment.obstacles) {
    prisms.push_back({obstacle.points_m, 0.0, kWithoutEnd_m});
  }
  for (const config::Clutter& clutter : experiment.sim.clutter) {
    prisms.push_back({clutter.points_m, clutter.bottom_m, clutter.top_m});
  }
  return prisms;
}

void addPerson(const Pedestrian& person, const config::Pedestrians& settings,
               std::vector<Cylinder>& cylinders) {
  const double height_m = settings.height_m;
  for (const Eigen::Vector2d& leg_m : legsOf(person)) {
    cylinders.push_back({leg_m, settings.leg_radius_m, 0.0, kHip * height_m});
  }
  cylinders.push_back({person.position_m, kTrunkRadius_m, kHip * height_m, kShoulder * height_m});
  cylinders.push_back({person.position_m, kHeadRadius_m, kShoulder * height_m, height_m});
}

}  // namespace

Cameras::Cameras(const config::Experiment& experiment, std::size_t most_bytes)
    : most_bytes_(most_bytes),
      people_(experiment.pedestrians),
      obstacles_(config::outlinesOf(experiment.obstacles)),
      room_(experiment.room.min_m.head<2>(), experiment.room.max_m.head<2>()),
      prisms_(prismsOf(experiment)) {
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const config::Vehicle& vehicle = experiment.vehicles[i];
    radii_m_.push_back(vehicle.body_radius_m);
    for (const config::Camera& camera : vehicle.cameras) {
      const core::TickTimer timer(camera.rate_hz);
      if (camera.depth) {
        depth_cameras_.push_back(
            {i, DepthCamera(camera), timer,
             core::RandomStream(experiment.seed, "depth " + vehicle.name + " " + camera.name)});
      } else {
        cameras_.push_back({i, CameraModel(camera), timer});
      }
    }
  }
}

std::span<const Cameras::Shot> Cameras::shoot(core::Utime now, std::span<const BodyState> bodies,
                                              std::span<const Pedestrian> people) {
  shots_.clear();
  for (Mounted& camera : cameras_) {
    if (camera.timer.due(now)) {
      shots_.push_back({camera.vehicle, camera.model.settings().name,
                        takePicture(camera.model, now, bodies[camera.vehicle], people)});
    }
  }
  for (MountedDepth& camera : depth_cameras_) {
    if (camera.timer.due(now)) {
      shots_.push_back(
          {camera.vehicle, camera.model.settings().name, takeDepths(camera, now, bodies, people)});
    }
  }
  return shots_;
}

core::JpegImage Cameras::takePicture(CameraModel& model, core::Utime now, const BodyState& own,
                                     std::span<const Pedestrian> people) const {
  const config::Camera& settings = model.settings();
  const std::span<const std::uint8_t> rgb =
      model.render(own.position_world_m.head<2>(), core::headingOf(own.orientation),
                   {obstacles_, room_}, people, people_.height_m);
  return {now, settings.width, settings.height,
          encodeJpeg(rgb, settings.width, settings.height, most_bytes_)};
}

core::DepthImage Cameras::takeDepths(MountedDepth& camera, core::Utime now,
                                     std::span<const BodyState> bodies,
                                     std::span<const Pedestrian> people) {
  const config::Camera& settings = camera.model.settings();
  const BodyState& own = bodies[camera.vehicle];
  cylinders_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i != camera.vehicle) {
      cylinders_.push_back({bodies[i].position_world_m.head<2>(), radii_m_[i], 0.0, kWithoutEnd_m});
    }
  }
  for (const Pedestrian& person : people) {
    addPerson(person, people_, cylinders_);
  }
  const std::span<const std::uint16_t> depth_mm =
      camera.model.render(own.position_world_m.head<2>(), core::headingOf(own.orientation),
                          {prisms_, cylinders_, room_}, &camera.noise);
  return {now, settings.width, settings.height, {depth_mm.begin(), depth_mm.end()}};
}

}  // namespace roundabout::sim
