#pragma once

#include <limits>
#include <span>
#include <vector>

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
  /// Of the way to where it goes in the end, if goal_world_m is but a place on it; NaN: it is not.
  double way_left_m = std::numeric_limits<double>::quiet_NaN();
};

/// What the ego agent knows of another one (paper: the observable state s^o). World frame.
struct OtherAgent {
  static constexpr int kNobody = -1;

  Eigen::Vector2d position_world_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double radius_m = 0.5;
  int id = kNobody;  ///< the same in every call for the same agent; kNobody: not known
};

/// A static obstacle: the corners of a simple polygon, counter-clockwise, in the world frame, m.
using Polygon = std::vector<Eigen::Vector2d>;

/// One sweep of a planar range finder on the ego agent.
struct RangeScan {
  double first_angle_rad = 0.0;  ///< of ranges_m[0], from the ego's heading, counter-clockwise
  double angle_step_rad = 0.0;   ///< between neighbouring ranges
  double max_range_m = 0.0;      ///< what a range says that hits nothing
  std::span<const float> ranges_m;
};

/// All that a policy is told of the world around the ego agent.
struct Surroundings {
  Surroundings() = default;
  // Implicit: most policies need the others only.
  Surroundings(std::span<const OtherAgent> the_others) : others(the_others) {}
  Surroundings(const std::vector<OtherAgent>& the_others) : others(the_others) {}

  std::span<const OtherAgent> others{};
  std::span<const Polygon> obstacles{};
  RangeScan scan{};  ///< without ranges for policies that need none
};

}  // namespace roundabout::core
