#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "common/core/agent.h"
#include "common/core/angles.h"
#include "common/core/polygon.h"
#include "planner/policy.h"

namespace roundabout::planner {

/// Agents that do at once what their policies say: all decide on the same state, then all move.
/// They go on after they have reached their goals.
class IdealFlight {
 public:
  static constexpr double kStepS = 0.1;
  static constexpr double kGoalDistanceM = 0.2;

  std::vector<core::Polygon> obstacles;  ///< that all policies are told of

  /// Standing, heading toward its goal.
  void add(core::EgoAgent start, std::unique_ptr<Policy> policy) {
    const Eigen::Vector2d to_goal = start.goal_world_m - start.position_world_m;
    start.heading_world_rad = std::atan2(to_goal.y(), to_goal.x());
    start.velocity_world_mps.setZero();
    agents_.push_back({start, std::move(policy)});
  }

  /// Until all have been at their goals or the time is up.
  void flyFor(double duration_s) {
    for (double time_s = 0.0; time_s < duration_s && !allArrived(); time_s += kStepS) {
      flyStep();
    }
  }

  bool allArrived() const {
    return std::all_of(agents_.begin(), agents_.end(), [](const Agent& a) { return a.arrived; });
  }

  int arrived() const {
    return static_cast<int>(
        std::count_if(agents_.begin(), agents_.end(), [](const Agent& a) { return a.arrived; }));
  }

  /// Smallest distance between the edges of an agent and an obstacle so far. m.
  double closestObstacle() const { return closest_obstacle_m_; }

  /// Smallest distance between the edges of two agents so far. m.
  double closestGap() const { return closest_gap_m_; }

 private:
  struct Agent {
    core::EgoAgent ego;
    std::unique_ptr<Policy> policy;
    bool arrived = false;
  };

  void flyStep() {
    std::vector<Decision> decisions;
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      const std::vector<core::OtherAgent> others = othersOf(i);
      core::Surroundings around(others);
      around.obstacles = obstacles;
      decisions.push_back(agents_[i].policy->decide(agents_[i].ego, around));
    }
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      move(agents_[i], decisions[i]);
    }
    for (const Agent& agent : agents_) {
      for (const core::Polygon& obstacle : obstacles) {
        closest_obstacle_m_ =
            std::min(closest_obstacle_m_,
                     core::distanceTo(obstacle, agent.ego.position_world_m) - agent.ego.radius_m);
      }
    }
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      for (std::size_t j = i + 1; j < agents_.size(); ++j) {
        const core::EgoAgent& a = agents_[i].ego;
        const core::EgoAgent& b = agents_[j].ego;
        const double distance = (a.position_world_m - b.position_world_m).norm();
        closest_gap_m_ = std::min(closest_gap_m_, distance - a.radius_m - b.radius_m);
      }
    }
  }

  std::vector<core::OtherAgent> othersOf(std::size_t self) const {
    std::vector<core::OtherAgent> others;
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      if (i != self) {
        const core::EgoAgent& other = agents_[i].ego;
        others.push_back({other.position_world_m, other.velocity_world_mps, other.radius_m});
      }
    }
    return others;
  }

  static void move(Agent& agent, const Decision& decision) {
    core::EgoAgent& ego = agent.ego;
    ego.heading_world_rad = core::wrapToPi(ego.heading_world_rad + decision.heading_change_rad);
    ego.velocity_world_mps = decision.speed_mps * Eigen::Vector2d(std::cos(ego.heading_world_rad),
                                                                  std::sin(ego.heading_world_rad));
    ego.position_world_m += ego.velocity_world_mps * kStepS;
    agent.arrived =
        agent.arrived || (ego.goal_world_m - ego.position_world_m).norm() <= kGoalDistanceM;
  }

  std::vector<Agent> agents_;
  double closest_obstacle_m_ = std::numeric_limits<double>::infinity();
  double closest_gap_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace roundabout::planner
