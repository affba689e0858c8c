#pragma once

#include <numbers>
#include <vector>

#include "common/core/agent.h"
#include "common/core/random.h"

namespace roundabout::planner {

/// What a policy is asked about.
struct Scene {
  core::EgoAgent ego;
  std::vector<core::OtherAgent> others;
};

inline Eigen::Vector2d randomVector(core::RandomStream& random, double bound) {
  const double x = random.uniform(-bound, bound);
  const double y = random.uniform(-bound, bound);
  return {x, y};
}

/// Agents anywhere in a square of twice half_side_m, so that in a small one bodies overlap; speeds
/// and radii as in the published cases.
inline Scene randomScene(core::RandomStream& random, std::size_t num_others, double half_side_m) {
  Scene scene;
  scene.ego.position_world_m = randomVector(random, half_side_m);
  scene.ego.velocity_world_mps = randomVector(random, 1.0);
  scene.ego.heading_world_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
  scene.ego.goal_world_m = randomVector(random, half_side_m);
  scene.ego.preferred_speed_mps = random.uniform(0.5, 1.5);
  scene.ego.radius_m = random.uniform(0.2, 0.8);
  for (std::size_t i = 0; i < num_others; ++i) {
    core::OtherAgent other;
    other.position_world_m = randomVector(random, half_side_m);
    other.velocity_world_mps = randomVector(random, 1.0);
    other.radius_m = random.uniform(0.2, 0.8);
    scene.others.push_back(other);
  }
  return scene;
}

}  // namespace roundabout::planner
