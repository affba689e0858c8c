#pragma once

#include <Eigen/Core>

namespace roundabout::core {

/// The agent that decides, in the plane. World frame (paper, section "Problem Formulation": s and
/// s^h).
struct EgoAgent {
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double heading_world_rad = 0.0;
  Eigen::Vector2d goal_world_m = Eigen::Vector2d::Zero();
  double preferred_speed_mps = 1.0;
  double radius_m = 0.5;
};

/// What the ego agent knows of another one (paper: the observable state s^o). World frame.
struct OtherAgent {
  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double radius_m = 0.5;
};

}  // namespace roundabout::core
