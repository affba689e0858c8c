#include "sim/start_places.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include <spdlog/fmt/fmt.h>

#include "common/config/obstacles.h"
#include "common/config/spacing.h"
#include "common/core/error.h"
#include "common/core/polygon.h"
#include "common/core/random.h"

namespace roundabout::sim {

namespace {

// Places drawn early can leave no room for the last vehicle: then everybody is drawn anew.
constexpr int kLayouts = 200;
constexpr int kDrawsPerVehicle = 200;

bool clearOfObstacles(const config::Experiment& experiment, const Eigen::Vector2d& place) {
  std::vector<core::Polygon> places = config::placesToAvoid(experiment);
  for (const config::Clutter& clutter : experiment.sim.clutter) {
    places.push_back(clutter.points_m);
  }
  return std::all_of(places.begin(), places.end(), [&](const core::Polygon& polygon_m) {
    return core::distanceTo(polygon_m, place) >= config::obstacleSpacingM(experiment);
  });
}

// Of a lab's file, simulated behind emulated motion capture, area and spacing were not checked when
// it was read.
bool isLabs(const config::Experiment& experiment) { return experiment.source != "sim"; }

bool inRoom(const config::Experiment& experiment, const Eigen::Vector2d& place) {
  const double wall_m = config::largestBodyRadiusM(experiment);
  return ((place - experiment.room.min_m.head<2>()).array() >= wall_m).all() &&
         ((experiment.room.max_m.head<2>() - place).array() >= wall_m).all();
}

std::optional<config::Start> drawPlace(const config::Experiment& experiment,
                                       const std::vector<Eigen::Vector2d>& taken,
                                       core::RandomStream& random) {
  const config::Sim& sim = experiment.sim;
  const double spacing_m = isLabs(experiment)
                               ? std::max(sim.start_spacing_m, config::goalSpacingM(experiment))
                               : sim.start_spacing_m;
  for (int draw = 0; draw < kDrawsPerVehicle; ++draw) {
    const double x = random.uniform(sim.start_area.min_m.x(), sim.start_area.max_m.x());
    const double y = random.uniform(sim.start_area.min_m.y(), sim.start_area.max_m.y());
    const Eigen::Vector2d place(x, y);
    if (std::all_of(
            taken.begin(), taken.end(),
            [&](const Eigen::Vector2d& other) { return (place - other).norm() >= spacing_m; }) &&
        (!isLabs(experiment) || inRoom(experiment, place)) && clearOfObstacles(experiment, place)) {
      return config::Start{place, random.uniform(-std::numbers::pi, std::numbers::pi)};
    }
  }
  return std::nullopt;
}

std::optional<std::vector<config::Start>> drawLayout(const config::Experiment& experiment,
                                                     core::RandomStream& random) {
  std::vector<Eigen::Vector2d> taken;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    if (vehicle.start) {
      taken.push_back(vehicle.start->position_m);
    }
  }
  std::vector<config::Start> starts;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    std::optional<config::Start> start =
        vehicle.start ? vehicle.start : drawPlace(experiment, taken, random);
    if (!start) {
      return std::nullopt;
    }
    starts.push_back(*start);
    taken.push_back(start->position_m);
  }
  return starts;
}

}  // namespace

std::vector<config::Start> startPlaces(const config::Experiment& experiment) {
  core::RandomStream random(experiment.seed, "start");
  for (int layout = 0; layout < kLayouts; ++layout) {
    if (auto starts = drawLayout(experiment, random)) {
      return *starts;
    }
  }
  const Eigen::Vector2d size = experiment.sim.start_area.max_m - experiment.sim.start_area.min_m;
  throw core::StartupError(experiment.file, "sim.start_area",
                           fmt::format("room for {} vehicles {:.2f} m apart (sim.start_spacing_m)",
                                       experiment.vehicles.size(), experiment.sim.start_spacing_m),
                           fmt::format("{:.2f} x {:.2f} m, where none was found in {} tries",
                                       size.x(), size.y(), kLayouts));
}

}  // namespace roundabout::sim
