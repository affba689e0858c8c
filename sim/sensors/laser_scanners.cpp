#include "sim/sensors/laser_scanners.h"

#include "common/config/obstacles.h"
#include "common/core/angles.h"
#include "common/core/vehicle_state.h"

namespace roundabout::sim {

namespace {

/// Of obstacles, and of the clutter that is there at a height.
std::vector<core::Polygon> outlinesAt(const config::Experiment& experiment, double height_m) {
  std::vector<core::Polygon> outlines = config::outlinesOf(experiment.obstacles);
  for (const config::Clutter& clutter : experiment.sim.clutter) {
    if (clutter.bottom_m <= height_m && height_m < clutter.top_m) {
      outlines.push_back(clutter.points_m);
    }
  }
  return outlines;
}

}  // namespace

LaserScanners::LaserScanners(const config::Experiment& experiment)
    : leg_radius_m_(experiment.pedestrians.leg_radius_m),
      room_(experiment.room.min_m.head<2>(), experiment.room.max_m.head<2>()) {
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const config::Vehicle& vehicle = experiment.vehicles[i];
    radii_m_.push_back(vehicle.body_radius_m);
    if (vehicle.lidar) {
      scanners_.push_back({i, Lidar(*vehicle.lidar), core::TickTimer(vehicle.lidar->rate_hz),
                           core::RandomStream(experiment.seed, "lidar " + vehicle.name),
                           outlinesAt(experiment, vehicle.height_m)});
    }
  }
}

/// How it moved since the sweep before, or not at all at the first.
SensorMotion LaserScanners::motionOf(Scanner& scanner, core::Utime now, const BodyState& own) {
  const double heading_rad = core::headingOf(own.orientation);
  SensorMotion motion;
  if (scanner.last_sweep > 0) {
    motion.velocity_mps = own.velocity_world_mps.head<2>();
    motion.turn_rate_radps = core::wrapToPi(heading_rad - scanner.last_heading_rad) /
                             core::toSeconds(now - scanner.last_sweep);
  }
  scanner.last_heading_rad = heading_rad;
  scanner.last_sweep = now;
  return motion;
}

std::span<const LaserScanners::Sweep> LaserScanners::sweep(core::Utime now,
                                                           std::span<const BodyState> bodies,
                                                           std::span<const Pedestrian> people) {
  sweeps_.clear();
  for (Scanner& scanner : scanners_) {
    if (!scanner.timer.due(now)) {
      continue;
    }
    discs_.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (i != scanner.vehicle) {
        discs_.push_back({bodies[i].position_world_m.head<2>(), radii_m_[i]});
      }
    }
    for (const Pedestrian& person : people) {
      for (const Eigen::Vector2d& leg : legsOf(person)) {
        discs_.push_back({leg, leg_radius_m_});
      }
    }
    const BodyState& own = bodies[scanner.vehicle];
    const bool walls = scanner.lidar.settings().sees_room_walls;
    const core::RangeScan seen =
        scanner.lidar.sweep(own.position_world_m.head<2>(), core::headingOf(own.orientation),
                            {discs_, scanner.outlines, walls ? &room_ : nullptr}, &scanner.noise,
                            motionOf(scanner, now, own));
    sweeps_.push_back({scanner.vehicle,
                       {now,
                        seen.first_angle_rad,
                        seen.angle_step_rad,
                        {seen.ranges_m.begin(), seen.ranges_m.end()}}});
  }
  return sweeps_;
}

}  // namespace roundabout::sim
