#include "logs/metrics/obstacles.h"

#include <algorithm>
#include <cmath>

#include "common/config/obstacles.h"
#include "common/core/polygon.h"
#include "logs/metrics/whereabouts.h"

namespace roundabout::logs {

namespace {

// The way between two frames is looked at in steps of no more than this: a frame's at 2 m/s.
constexpr double kStepM = 0.01;

/// One vehicle and one obstacle.
class ObstacleWatch {
 public:
  ObstacleWatch(const Flight& flight, const FlightVehicle& vehicle, const Whereabouts& whereabouts,
                const config::Obstacle& obstacle)
      : flight_(flight), vehicle_(vehicle), whereabouts_(whereabouts), obstacle_(obstacle) {}

  ClosestGap closest() const {
    ClosestGap closest;
    closest.vehicle_a = vehicle_.name;
    closest.vehicle_b = obstacle_.name;
    for (std::size_t frame = 0; frame < flight_.frames.size(); ++frame) {
      seeAfter(frame, closest);
    }
    return closest;
  }

  bool couldTouchIn(const Whereabouts::Stretch& stretch) const {
    for (std::size_t frame = stretch.begin; frame < stretch.end; ++frame) {
      if (whereabouts_.apartAtLeastM(obstacle_.points_m, frame) < vehicle_.body_radius_m) {
        return true;
      }
    }
    return false;
  }

 private:
  /// Who rests on the floor was put there.
  void seeAfter(std::size_t frame, ClosestGap& closest) const {
    const core::Utime begin = flight_.frames[frame].utime;
    if (!whereabouts_.knownAfter(frame)) {
      if (whereabouts_.known(frame) && !whereabouts_.rests(frame)) {
        see(whereabouts_.place(frame), begin, closest);
      }
      return;
    }
    if (whereabouts_.restsAfter(frame)) {
      return;
    }
    const Eigen::Vector2d way_m = whereabouts_.place(frame + 1) - whereabouts_.place(frame);
    const double time_s = core::toSeconds(flight_.frames[frame + 1].utime - begin);
    const int steps = std::max(1, static_cast<int>(std::ceil(way_m.norm() / kStepM)));
    for (int step = 0; step < steps; ++step) {
      const double share = static_cast<double>(step) / steps;
      see(whereabouts_.place(frame) + share * way_m, begin + core::toUtime(share * time_s),
          closest);
    }
  }

  void see(const Eigen::Vector2d& place_m, core::Utime utime, ClosestGap& closest) const {
    const double gap_m = core::distanceTo(obstacle_.points_m, place_m) - vehicle_.body_radius_m;
    if (gap_m < closest.gap_m) {
      closest.gap_m = gap_m;
      closest.at_s = flight_.secondsAt(utime);
    }
  }

  const Flight& flight_;
  const FlightVehicle& vehicle_;
  const Whereabouts& whereabouts_;
  const config::Obstacle& obstacle_;
};

void addUnseen(const Flight& flight, const FlightVehicle& vehicle,
               const std::vector<config::Obstacle>& standing,
               const std::vector<ObstacleWatch>& watches, const Whereabouts::Stretch& stretch,
               std::vector<Unseen>& unseen) {
  Unseen found{vehicle.name,
               flight.secondsAt(flight.frames[stretch.begin].utime),
               flight.secondsAt(flight.frames[stretch.end].utime),
               {}};
  for (std::size_t i = 0; i < watches.size(); ++i) {
    if (watches[i].couldTouchIn(stretch)) {
      found.near.push_back(standing[i].name);
    }
  }
  if (!found.near.empty()) {
    unseen.push_back(std::move(found));
  }
}

void measure(const Flight& flight, const FlightVehicle& vehicle,
             const std::vector<config::Obstacle>& standing, ObstacleMetrics& metrics) {
  const Whereabouts whereabouts(flight, vehicle);
  std::vector<ObstacleWatch> watches;
  for (const config::Obstacle& obstacle : standing) {
    watches.emplace_back(flight, vehicle, whereabouts, obstacle);
    const ClosestGap gap = watches.back().closest();
    if (gap.gap_m < metrics.closest.gap_m) {
      metrics.closest = gap;
    }
    if (gap.gap_m < 0.0) {
      metrics.touches.push_back(gap);
    }
  }
  for (const Whereabouts::Stretch& stretch : whereabouts.unknown()) {
    addUnseen(flight, vehicle, standing, watches, stretch, metrics.unseen);
  }
}

}  // namespace

ObstacleMetrics obstaclesOf(const Flight& flight) {
  ObstacleMetrics metrics;
  const std::vector<config::Obstacle> standing = flight.experiment
                                                     ? config::standingInSim(*flight.experiment)
                                                     : std::vector<config::Obstacle>{};
  if (!standing.empty()) {
    for (const FlightVehicle& vehicle : flight.vehicles) {
      measure(flight, vehicle, standing, metrics);
    }
  }
  return metrics;
}

}  // namespace roundabout::logs
