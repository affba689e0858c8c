#pragma once

#include <optional>
#include <span>

#include "planner/shield/scene.h"

namespace roundabout::planner::shield {

/// Where a parked vehicle goes while somebody asks for the way past its goal: off the line from the
/// asker to the asker's goal, to the nearer side. Nothing: it may stay.
std::optional<Eigen::Vector2d> placeAside(const Ego& ego, const Scene& scene,
                                          std::span<const Neighbour> neighbours,
                                          const ShieldParameters& parameters);

}  // namespace roundabout::planner::shield
