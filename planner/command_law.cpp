#include "planner/command_law.h"

#include <algorithm>
#include <cmath>

#include "common/core/angles.h"

namespace roundabout::planner {

PlanarCommand commandFrom(const Decision& decision, const core::EgoAgent& ego,
                          const config::Planner& settings) {
  const double distance_m = (ego.goal_world_m - ego.position_world_m).norm();
  const double share = std::min(1.0, distance_m / settings.slow_down_distance_m);
  const double speed_mps = share * std::clamp(decision.speed_mps, 0.0, ego.preferred_speed_mps);
  const double change_rad = decision.heading_change_rad * (decision.action >= 0 ? share : 1.0);

  PlanarCommand command;
  command.heading_world_rad = core::wrapToPi(ego.heading_world_rad + change_rad);
  command.heading_rate_radps = settings.heading_gain_per_s * change_rad;
  command.velocity_world_mps = speed_mps * Eigen::Vector2d(std::cos(command.heading_world_rad),
                                                           std::sin(command.heading_world_rad));
  return command;
}

bool holdsPosition(const core::EgoAgent& ego, const config::Planner& settings) {
  return (ego.goal_world_m - ego.position_world_m).norm() <= settings.hold_distance_m;
}

}  // namespace roundabout::planner
