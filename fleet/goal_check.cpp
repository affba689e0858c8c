#include "fleet/goal_check.h"

#include <spdlog/fmt/fmt.h>

#include "common/config/spacing.h"
#include "common/core/polygon.h"

namespace roundabout::fleet {

Eigen::Vector3d nearestGoal(const config::Experiment& experiment, std::size_t vehicle,
                            const Eigen::Vector3d& place_m) {
  const double body_m = experiment.vehicles[vehicle].body_radius_m;
  const Eigen::Vector3d margin_m(body_m, body_m, 0.0);
  return place_m.cwiseMax(experiment.room.min_m + margin_m)
      .cwiseMin(experiment.room.max_m - margin_m);
}

namespace {

std::optional<std::string> refuseGoalsAtObstacles(const config::Experiment& experiment,
                                                  const std::vector<Eigen::Vector3d>& points_m) {
  const double needed_m = config::obstacleSpacingM(experiment);
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    for (const auto& [kind, list] : {std::pair{"obstacle", &experiment.obstacles},
                                     std::pair{"no-fly zone", &experiment.no_fly_zones}}) {
      for (const config::Obstacle& obstacle : *list) {
        const double distance_m = core::distanceTo(obstacle.points_m, points_m[i].head<2>());
        if (distance_m < 0.0) {
          return fmt::format("goal {} is inside {} {}", i + 1, kind, obstacle.name);
        }
        if (distance_m < needed_m) {
          return fmt::format("goal {} is {:.2f} m from {} {} and must be {:.2f} m", i + 1,
                             distance_m, kind, obstacle.name, needed_m);
        }
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> refuseGoals(const config::Experiment& experiment,
                                       const std::vector<Eigen::Vector3d>& points_m) {
  if (points_m.size() > experiment.vehicles.size()) {
    return fmt::format("{} goals are more than {} vehicles", points_m.size(),
                       experiment.vehicles.size());
  }
  const double body_m = config::largestBodyRadiusM(experiment);
  const config::Room& room = experiment.room;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d& point = points_m[i];
    if (!point.allFinite()) {
      return fmt::format("goal {} is not a number", i + 1);
    }
    const bool inside = (point.head<2>().array() - body_m >= room.min_m.head<2>().array()).all() &&
                        (point.head<2>().array() + body_m <= room.max_m.head<2>().array()).all() &&
                        point.z() >= room.min_m.z() && point.z() <= room.max_m.z();
    if (!inside) {
      return fmt::format(
          "goal {} at ({:.2f}, {:.2f}, {:.2f}) is outside the room, which reaches from ({:.2f}, "
          "{:.2f}, {:.2f}) to ({:.2f}, {:.2f}, {:.2f}) less a body radius of {:.2f} m",
          i + 1, point.x(), point.y(), point.z(), room.min_m.x(), room.min_m.y(), room.min_m.z(),
          room.max_m.x(), room.max_m.y(), room.max_m.z(), body_m);
    }
  }
  if (auto refusal = refuseGoalsAtObstacles(experiment, points_m)) {
    return refusal;
  }
  constexpr double kRounding_m = 1e-9;
  const double needed_m = config::goalSpacingM(experiment);
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    for (std::size_t j = i + 1; j < points_m.size(); ++j) {
      const double distance_m = (points_m[i] - points_m[j]).head<2>().norm();
      if (distance_m < needed_m - kRounding_m) {
        return fmt::format("goals {} and {} are {:.2f} m apart and must be {:.2f} m", i + 1, j + 1,
                           distance_m, needed_m);
      }
    }
  }
  return std::nullopt;
}

}  // namespace roundabout::fleet
