#pragma once

#include <array>

#include <Eigen/Core>

#include "common/core/agent.h"

namespace roundabout::planner {

/// A velocity that the ego could take. World frame.
struct Candidate {
  double speed_mps = 0.0;
  double heading_world_rad = 0.0;
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
};

inline constexpr int kCandidates = 47;

/// What SA-CADRL chooses from when nothing limits its turns ("no_constr"): what it does now, five
/// speeds to the goal, standing, and four speeds in ten directions up to 60 degrees off its
/// heading. Of equally good ones the first is taken. Standing has the heading 0 of the world frame,
/// as in the published code: it turns the agent to the world's +x.
std::array<Candidate, kCandidates> candidatesOf(const core::EgoAgent& ego);

}  // namespace roundabout::planner
