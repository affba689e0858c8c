#pragma once

#include <string>
#include <vector>

#include "common/config/checks.h"
#include "common/config/experiment.h"
#include "common/core/agent.h"

namespace roundabout::config {

/// Turns obstacles round whose corners were written clockwise.
void orientObstacles(std::vector<Obstacle>& obstacles);

/// Refuses those without a name of their own or that are no simple polygons. `key`: of the list.
void checkOutlines(const std::vector<Obstacle>& obstacles, const std::string& key,
                   const Refuse& refuse);

/// Refuses obstacles, no-fly zones and clutter without a name of their own, that are no simple
/// polygons, or that reach out of the room, and starting places too close to one
/// (obstacleSpacingM).
void checkObstacles(const Experiment& experiment, const Refuse& refuse);

/// Obstacles that stand in no experiment: a YAML file with the key `obstacles` alone, written as in
/// an experiment file. Throws core::StartupError with FILE:LINE.
std::vector<Obstacle> readObstacles(const std::string& path);

/// Their corners.
std::vector<core::Polygon> outlinesOf(const std::vector<Obstacle>& obstacles);

/// Obstacles, then the simulator's clutter, counter-clockwise.
std::vector<Obstacle> standingInSim(const Experiment& experiment);

/// The corners of obstacles, then of no-fly zones. m, world.
std::vector<core::Polygon> placesToAvoid(const Experiment& experiment);

}  // namespace roundabout::config
