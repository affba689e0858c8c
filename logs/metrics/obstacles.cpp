#include "logs/metrics/obstacles.h"

#include "common/core/polygon.h"

namespace roundabout::logs {

namespace {

ClosestGap closestTo(const Flight& flight, const FlightVehicle& vehicle,
                     const config::Obstacle& obstacle) {
  ClosestGap closest;
  closest.vehicle_a = vehicle.name;
  closest.vehicle_b = obstacle.name;
  for (std::size_t frame = 0; frame < flight.frames.size(); ++frame) {
    const Sample& sample = vehicle.samples[frame];
    if (!flight.underWay(vehicle, sample)) {
      continue;
    }
    const double gap_m = core::distanceTo(obstacle.points_m, sample.position_world_m.head<2>()) -
                         vehicle.body_radius_m;
    if (gap_m < closest.gap_m) {
      closest.gap_m = gap_m;
      closest.at_s = flight.secondsAt(flight.frames[frame].utime);
    }
  }
  return closest;
}

}  // namespace

ObstacleMetrics obstaclesOf(const Flight& flight) {
  ObstacleMetrics metrics;
  if (!flight.experiment) {
    return metrics;
  }
  for (const config::Obstacle& obstacle : flight.experiment->obstacles) {
    for (const FlightVehicle& vehicle : flight.vehicles) {
      const ClosestGap gap = closestTo(flight, vehicle, obstacle);
      if (gap.gap_m < metrics.closest.gap_m) {
        metrics.closest = gap;
      }
      if (gap.gap_m < 0.0) {
        metrics.touches.push_back(gap);
      }
    }
  }
  return metrics;
}

}  // namespace roundabout::logs
