#include "sim/sensors/laser_scanners.h"

#include "common/config/obstacles.h"
#include "common/core/vehicle_state.h"

namespace roundabout::sim {

LaserScanners::LaserScanners(const config::Experiment& experiment)
    : obstacles_(config::outlinesOf(experiment.obstacles)),
      room_(experiment.room.min_m.head<2>(), experiment.room.max_m.head<2>()) {
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const config::Vehicle& vehicle = experiment.vehicles[i];
    radii_m_.push_back(vehicle.body_radius_m);
    if (vehicle.lidar) {
      scanners_.push_back({i, Lidar(*vehicle.lidar), core::TickTimer(vehicle.lidar->rate_hz),
                           core::RandomStream(experiment.seed, "lidar " + vehicle.name)});
    }
  }
}

std::span<const LaserScanners::Sweep> LaserScanners::sweep(core::Utime now,
                                                           std::span<const BodyState> bodies) {
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
    const BodyState& own = bodies[scanner.vehicle];
    const bool walls = scanner.lidar.settings().sees_room_walls;
    const core::RangeScan seen =
        scanner.lidar.sweep(own.position_world_m.head<2>(), core::headingOf(own.orientation),
                            {discs_, obstacles_, walls ? &room_ : nullptr}, &scanner.noise);
    sweeps_.push_back({scanner.vehicle,
                       {now,
                        seen.first_angle_rad,
                        seen.angle_step_rad,
                        {seen.ranges_m.begin(), seen.ranges_m.end()}}});
  }
  return sweeps_;
}

}  // namespace roundabout::sim
