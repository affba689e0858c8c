#include "common/config/obstacles.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "common/config/spacing.h"
#include "common/config/words.h"
#include "common/core/polygon.h"

namespace roundabout::config {

namespace {

void checkCorners(const Room& room, const Obstacle& obstacle, const std::string& path,
                  const Refuse& refuse) {
  for (std::size_t i = 0; i < obstacle.points_m.size(); ++i) {
    const Eigen::Vector2d& corner = obstacle.points_m[i];
    const bool inside = (corner.array() >= room.min_m.head<2>().array()).all() &&
                        (corner.array() <= room.max_m.head<2>().array()).all();
    if (!inside) {
      refuse(fmt::format("{}.points_m[{}]", path, i),
             fmt::format("a place in the room (x {} to {}, y {} to {})", room.min_m.x(),
                         room.max_m.x(), room.min_m.y(), room.max_m.y()),
             fmt::format("[{}, {}]", corner.x(), corner.y()));
    }
  }
  if (obstacle.points_m.size() < 3) {
    refuse(path + ".points_m", "at least 3 corners", fmt::format("{}", obstacle.points_m.size()));
  }
  if (!core::isSimple(obstacle.points_m)) {
    refuse(path + ".points_m", "the corners of a polygon, in their order along its outline",
           "sides that touch or cross each other");
  }
}

void checkStarts(const Experiment& experiment, const Obstacle& obstacle, const Refuse& refuse) {
  const double needed_m = obstacleSpacingM(experiment);
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const std::optional<Start>& start = experiment.vehicles[i].start;
    if (!start) {
      continue;
    }
    const double distance_m = core::distanceTo(obstacle.points_m, start->position_m);
    if (distance_m < needed_m) {
      refuse(fmt::format("vehicles[{}].start.position_m", i),
             fmt::format("at least {} m (an assumed radius and safety.goal_margin_m) from obstacle "
                         "{}",
                         needed_m, quoted(obstacle.name)),
             distance_m < 0.0 ? "a place inside it" : fmt::format("{:.3f} m", distance_m));
    }
  }
}

}  // namespace

void orientObstacles(Experiment& experiment) {
  for (Obstacle& obstacle : experiment.obstacles) {
    if (core::signedArea(obstacle.points_m) < 0.0) {
      std::reverse(obstacle.points_m.begin(), obstacle.points_m.end());
    }
  }
}

void checkObstacles(const Experiment& experiment, const Refuse& refuse) {
  for (std::size_t i = 0; i < experiment.obstacles.size(); ++i) {
    const Obstacle& obstacle = experiment.obstacles[i];
    const std::string path = fmt::format("obstacles[{}]", i);
    if (obstacle.name.empty()) {
      refuse(path + ".name", "letters, digits and underscore", "nothing");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (experiment.obstacles[j].name == obstacle.name) {
        refuse(path + ".name", "a name of its own",
               fmt::format("{}, which is obstacles[{}]'s", quoted(obstacle.name), j));
      }
    }
    checkCorners(experiment.room, obstacle, path, refuse);
    checkStarts(experiment, obstacle, refuse);
  }
}

}  // namespace roundabout::config
