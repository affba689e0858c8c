#include "common/config/obstacles.h"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/config/document.h"
#include "common/config/reader.h"
#include "common/config/spacing.h"
#include "common/config/words.h"
#include "common/core/polygon.h"

namespace roundabout::config {

namespace {

struct ObstacleFile {
  std::vector<Obstacle> obstacles;
};

template <class Visitor>
void describe(Visitor& visit, ObstacleFile& file) {
  visit("obstacles", file.obstacles);
}

std::vector<Obstacle> outlinesOf(const std::vector<Clutter>& clutter) {
  std::vector<Obstacle> outlines;
  for (const Clutter& each : clutter) {
    outlines.push_back({each.name, each.points_m});
  }
  return outlines;
}

void checkInRoom(const Room& room, const Obstacle& obstacle, const std::string& path,
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
}

void checkStarts(const Experiment& experiment, const Obstacle& obstacle, const std::string& kind,
                 const Refuse& refuse) {
  const double needed_m = obstacleSpacingM(experiment);
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    const std::optional<Start>& start = experiment.vehicles[i].start;
    if (!start) {
      continue;
    }
    const double distance_m = core::distanceTo(obstacle.points_m, start->position_m);
    if (distance_m < needed_m) {
      refuse(fmt::format("vehicles[{}].start.position_m", i),
             fmt::format("at least {} m (an assumed radius and safety.goal_margin_m) from {} {}",
                         needed_m, kind, inQuotes(obstacle.name)),
             distance_m < 0.0 ? "a place inside it" : fmt::format("{:.3f} m", distance_m));
    }
  }
}

}  // namespace

void orientObstacles(std::vector<Obstacle>& obstacles) {
  for (Obstacle& obstacle : obstacles) {
    if (core::signedArea(obstacle.points_m) < 0.0) {
      std::reverse(obstacle.points_m.begin(), obstacle.points_m.end());
    }
  }
}

void checkOutlines(const std::vector<Obstacle>& obstacles, const std::string& key,
                   const Refuse& refuse) {
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const Obstacle& obstacle = obstacles[i];
    const std::string path = fmt::format("{}[{}]", key, i);
    if (obstacle.name.empty()) {
      refuse(path + ".name", "letters, digits and underscore", "nothing");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (obstacles[j].name == obstacle.name) {
        refuse(path + ".name", "a name of its own",
               fmt::format("{}, which is {}[{}]'s", inQuotes(obstacle.name), key, j));
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
}

void checkObstacles(const Experiment& experiment, const Refuse& refuse) {
  const auto check = [&](const std::vector<Obstacle>& list, const std::string& key,
                         const std::string& kind) {
    checkOutlines(list, key, refuse);
    for (std::size_t i = 0; i < list.size(); ++i) {
      checkInRoom(experiment.room, list[i], fmt::format("{}[{}]", key, i), refuse);
      checkStarts(experiment, list[i], kind, refuse);
    }
  };
  check(experiment.obstacles, "obstacles", "obstacle");
  check(experiment.no_fly_zones, "no_fly_zones", "no-fly zone");
  check(outlinesOf(experiment.sim.clutter), "sim.clutter", "clutter");
  for (std::size_t i = 0; i < experiment.sim.clutter.size(); ++i) {
    const Clutter& clutter = experiment.sim.clutter[i];
    if (clutter.top_m <= clutter.bottom_m) {
      refuse(fmt::format("sim.clutter[{}].top_m", i),
             fmt::format("more than bottom_m ({})", clutter.bottom_m),
             fmt::format("{}", clutter.top_m));
    }
  }
}

std::vector<Obstacle> standingInSim(const Experiment& experiment) {
  std::vector<Obstacle> standing = experiment.obstacles;
  for (Obstacle& clutter : outlinesOf(experiment.sim.clutter)) {
    standing.push_back(std::move(clutter));
  }
  orientObstacles(standing);
  return standing;
}

std::vector<core::Polygon> placesToAvoid(const Experiment& experiment) {
  std::vector<core::Polygon> places = outlinesOf(experiment.obstacles);
  for (const Obstacle& zone : experiment.no_fly_zones) {
    places.push_back(zone.points_m);
  }
  return places;
}

std::vector<Obstacle> readObstacles(const std::string& path) {
  const Document document(textOfFile(path, "obstacles"), path, {});
  ObstacleFile file;
  Reader reader(document, document.root(), "");
  describe(reader, file);
  reader.finish();
  if (file.obstacles.empty()) {
    document.fail("obstacles", "at least one", "none");
  }
  orientObstacles(file.obstacles);
  checkOutlines(file.obstacles, "obstacles",
                [&](const std::string& key, const std::string& expected, const std::string& found) {
                  document.fail(key, expected, found);
                });
  return std::move(file.obstacles);
}

std::vector<core::Polygon> outlinesOf(const std::vector<Obstacle>& obstacles) {
  std::vector<core::Polygon> outlines;
  for (const Obstacle& obstacle : obstacles) {
    outlines.push_back(obstacle.points_m);
  }
  return outlines;
}

}  // namespace roundabout::config
