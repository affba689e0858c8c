#include "learning/evaluation/ideal_world.h"

#include <cmath>
#include <numbers>

#include "common/core/polygon.h"

namespace roundabout::learning {

using Eigen::Vector2d;

double wrappedOnce(double angle_rad) {
  if (angle_rad >= std::numbers::pi) {
    return angle_rad - 2.0 * std::numbers::pi;
  }
  return angle_rad < -std::numbers::pi ? angle_rad + 2.0 * std::numbers::pi : angle_rad;
}

Vector2d velocityOf(const IdealAction& action, double heading_rad) {
  const double turned_rad =
      wrappedOnce(static_cast<double>(action.heading_change_rad) + heading_rad);
  return static_cast<double>(action.speed_mps) *
         Vector2d(std::cos(turned_rad), std::sin(turned_rad));
}

IdealWorld::IdealWorld(const Rules& rules, const TestCase& test_case, Trace* trace)
    : rules_(rules),
      obstacles_(test_case.obstacles),
      record_(rules, test_case, trace),
      time_left_s_(test_case.agents.size()) {
  for (const AgentSpec& spec : test_case.agents) {
    core::EgoAgent& agent = agents_.emplace_back();
    agent.position_world_m = spec.start_m;
    agent.preferred_speed_mps = spec.preferred_speed_mps;
    agent.radius_m = spec.radius_m;
    const Vector2d way = spec.goal_m - spec.start_m;
    agent.heading_world_rad = spec.heading_rad.value_or(std::atan2(way.y(), way.x()));
  }
}

void IdealWorld::beginLeg(std::span<const Vector2d> goals_m) {
  record_.beginLeg(goals_m, position_of_);
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    agents_[i].goal_world_m = goals_m[i];
    agents_[i].velocity_world_mps.setZero();
    time_left_s_[i] = rules_.time_ratio * record_[i].straight_time_s + rules_.time_allowance_s;
  }
  forAllPairs([](std::size_t, std::size_t, double) {});
  forAllBesideObstacles([](std::size_t, double) {});
}

void IdealWorld::step(std::span<const IdealAction> actions) {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    move(i, actions[i]);
  }
  collide();
  record_.endStep(position_of_);
}

std::span<const core::OtherAgent> IdealWorld::othersOf(std::size_t i) {
  others_.clear();
  for (std::size_t j = 0; j < agents_.size(); ++j) {
    if (j != i) {
      const core::EgoAgent& other = agents_[j];
      others_.push_back(
          {other.position_world_m, other.velocity_world_mps, other.radius_m, static_cast<int>(j)});
    }
  }
  return others_;
}

void IdealWorld::move(std::size_t i, const IdealAction& action) {
  core::EgoAgent& ego = agents_[i];
  EpisodeRecord::Agent& agent = record_[i];
  if (agent.done()) {
    ego.velocity_world_mps.setZero();
    return;
  }
  const Vector2d velocity = velocityOf(action, ego.heading_world_rad);
  ego.heading_world_rad =
      wrappedOnce(static_cast<double>(action.heading_change_rad) + ego.heading_world_rad);
  ego.position_world_m += velocity * rules_.planning_step_s;
  ego.velocity_world_mps = velocity;
  agent.time_s += rules_.planning_step_s;
  time_left_s_[i] -= rules_.planning_step_s;
  agent.at_goal = (ego.position_world_m - ego.goal_world_m).squaredNorm() <=
                  rules_.goal_distance_m * rules_.goal_distance_m;
  agent.timed_out = !agent.at_goal && time_left_s_[i] <= 0.0;
}

void IdealWorld::collide() {
  forAllPairs([this](std::size_t i, std::size_t j, double distance_m) {
    if (distance_m <= rules_.body_share * (agents_[i].radius_m + agents_[j].radius_m)) {
      record_[i].collided = !record_[i].at_goal;
      record_[j].collided = !record_[j].at_goal;
    }
  });
  forAllBesideObstacles([this](std::size_t i, double distance_m) {
    if (distance_m <= rules_.body_share * agents_[i].radius_m) {
      record_[i].collided = !record_[i].at_goal;
    }
  });
}

template <class Visit>
void IdealWorld::forAllPairs(Visit visit) {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    for (std::size_t j = i + 1; j < agents_.size(); ++j) {
      const core::EgoAgent& a = agents_[i];
      const core::EgoAgent& b = agents_[j];
      const double distance_m = (a.position_world_m - b.position_world_m).norm();
      record_.noteGap(distance_m - a.radius_m - b.radius_m);
      visit(i, j, distance_m);
    }
  }
}

template <class Visit>
void IdealWorld::forAllBesideObstacles(Visit visit) {
  for (const core::Polygon& obstacle : obstacles_) {
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      const double distance_m = core::distanceTo(obstacle, agents_[i].position_world_m);
      record_.noteGap(distance_m - agents_[i].radius_m);
      visit(i, distance_m);
    }
  }
}

}  // namespace roundabout::learning
