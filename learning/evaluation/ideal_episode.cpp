#include "learning/evaluation/ideal_episode.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/polygon.h"
#include "learning/evaluation/episode_record.h"
#include "sim/sensors/lidar.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

// As the published environment does it: an angle that needs no turn keeps its last bit.
double wrapped(double angle_rad) {
  if (angle_rad >= std::numbers::pi) {
    return angle_rad - 2.0 * std::numbers::pi;
  }
  return angle_rad < -std::numbers::pi ? angle_rad + 2.0 * std::numbers::pi : angle_rad;
}

/// One case, step by step, as the published environment does it.
class IdealEpisode {
 public:
  IdealEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew, Trace* trace)
      : rules_(rules),
        obstacles_(test_case.obstacles),
        crew_(crew),
        policies_(crew.policies),
        record_(rules, test_case, trace),
        time_left_s_(test_case.agents.size()),
        around_(test_case.agents.size()),
        actions_(test_case.agents.size()) {
    for (const AgentSpec& spec : test_case.agents) {
      core::EgoAgent& agent = agents_.emplace_back();
      agent.position_world_m = spec.start_m;
      agent.preferred_speed_mps = spec.preferred_speed_mps;
      agent.radius_m = spec.radius_m;
      const Vector2d way = spec.goal_m - spec.start_m;
      agent.heading_world_rad = std::atan2(way.y(), way.x());
    }
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      planner::shield::ShieldParameters parameters =
          planner::shield::ShieldParameters::idealRules();
      parameters.period_s = parameters.hold_s = rules.planning_step_s;
      parameters.suit(policies_[i]->name());
      shields_.emplace_back(parameters);
    }
  }

  void fly(std::span<const Vector2d> goals_m) {
    record_.beginLeg(goals_m, position_of_);
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      policies_[i]->reset();
      shields_[i].reset();
      agents_[i].goal_world_m = goals_m[i];
      agents_[i].velocity_world_mps.setZero();
      time_left_s_[i] = rules_.time_ratio * record_[i].straight_time_s;
    }
    forAllPairs([](std::size_t, std::size_t, double) {});
    forAllBesideObstacles([](std::size_t, double) {});
    while (!record_.allDone()) {
      step();
    }
    record_.endLeg();
  }

  const EpisodeRecord& record() const { return record_; }

 private:
  struct Action {
    float speed_mps;
    float heading_change_rad;
  };

  void step() {
    decide();
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      move(i);
    }
    collide();
    record_.endStep(position_of_);
  }

  void decide() {
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      const core::EgoAgent& agent = agents_[i];
      around_[i] = {agent.position_world_m, agent.velocity_world_mps, agent.radius_m,
                    static_cast<int>(i)};
    }
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      if (record_[i].done()) {
        continue;
      }
      others_.assign(around_.begin(), around_.end());
      others_.erase(others_.begin() + static_cast<std::ptrdiff_t>(i));
      core::Surroundings around(others_);
      around.obstacles = obstacles_;
      if (policies_[i]->needsScan()) {
        around.scan = scanOf(i);
      }
      const planner::Decision decision = policies_[i]->decide(agents_[i], around);
      actions_[i] = actionOf(decision.speed_mps, decision.heading_change_rad);
      record_.noteDecision();
      if (crew_.isShielded(i)) {
        shield(i);
      }
    }
  }

  // The published environment passes actions on in single precision.
  static Action actionOf(double speed_mps, double heading_change_rad) {
    return {static_cast<float>(speed_mps), static_cast<float>(heading_change_rad)};
  }

  Vector2d velocityOf(const Action& action, double heading_rad) const {
    const double turned_rad = wrapped(static_cast<double>(action.heading_change_rad) + heading_rad);
    return static_cast<double>(action.speed_mps) *
           Vector2d(std::cos(turned_rad), std::sin(turned_rad));
  }

  void shield(std::size_t i) {
    const core::EgoAgent& agent = agents_[i];
    planner::shield::Ego ego;
    ego.motion = motionOf(agent);
    ego.radius_m = rules_.body_share * agent.radius_m;
    ego.goal_world_m = agent.goal_world_m;
    ego.preferred_speed_mps = ego.max_speed_mps = agent.preferred_speed_mps;
    ego.id = static_cast<int>(i);
    neighbours_.clear();
    for (std::size_t j = 0; j < agents_.size(); ++j) {
      if (j == i) {
        continue;
      }
      planner::shield::Neighbour& other = neighbours_.emplace_back();
      other.motion = motionOf(agents_[j]);
      other.radius_m = rules_.body_share * agents_[j].radius_m;
      other.max_speed_mps = agents_[j].preferred_speed_mps;
      other.id = static_cast<int>(j);
      other.shielded = crew_.isShielded(j);
      other.parked = record_[j].done();
    }
    const Vector2d wanted = velocityOf(actions_[i], agent.heading_world_rad);
    const planner::shield::ShieldDecision decision =
        shields_[i].decide(ego, neighbours_, {.obstacles = obstacles_}, wanted, record_[i].time_s);
    record_.noteLayer(decision.layer);
    const Vector2d& flown = decision.velocity_world_mps;
    if (flown == wanted) {
      return;
    }
    const double speed_mps = flown.norm();
    const double across = wanted.x() * flown.y() - wanted.y() * flown.x();
    if (speed_mps > 0.0 && (wanted.dot(flown) <= 0.0 || std::abs(across) > 1e-9)) {
      const double course_rad = std::atan2(flown.y(), flown.x());
      actions_[i] = actionOf(speed_mps, wrapped(course_rad - agent.heading_world_rad));
    } else {
      actions_[i] = actionOf(speed_mps, static_cast<double>(actions_[i].heading_change_rad));
    }
  }

  static planner::shield::Motion motionOf(const core::EgoAgent& agent) {
    planner::shield::Motion motion;
    motion.position_world_m = agent.position_world_m;
    motion.velocity_world_mps = agent.velocity_world_mps;
    motion.heading_world_rad = agent.heading_world_rad;
    return motion;
  }

  core::RangeScan scanOf(std::size_t agent) {
    discs_.clear();
    for (const core::OtherAgent& other : others_) {
      discs_.push_back({other.position_world_m, other.radius_m});
    }
    const core::EgoAgent& ego = agents_[agent];
    return lidar_.sweep(ego.position_world_m, ego.heading_world_rad,
                        {.discs = discs_, .polygons = obstacles_});
  }

  void move(std::size_t i) {
    core::EgoAgent& ego = agents_[i];
    EpisodeRecord::Agent& agent = record_[i];
    if (agent.done()) {
      ego.velocity_world_mps.setZero();
      return;
    }
    const double speed_mps = actions_[i].speed_mps;
    const double heading_rad =
        wrapped(static_cast<double>(actions_[i].heading_change_rad) + ego.heading_world_rad);
    const Vector2d velocity(speed_mps * std::cos(heading_rad), speed_mps * std::sin(heading_rad));
    ego.position_world_m += velocity * rules_.planning_step_s;
    ego.velocity_world_mps = velocity;
    ego.heading_world_rad = heading_rad;
    agent.time_s += rules_.planning_step_s;
    time_left_s_[i] -= rules_.planning_step_s;
    agent.at_goal = (ego.position_world_m - ego.goal_world_m).squaredNorm() <=
                    rules_.goal_distance_m * rules_.goal_distance_m;
    agent.timed_out = !agent.at_goal && time_left_s_[i] <= 0.0;
  }

  void collide() {
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
  void forAllPairs(Visit visit) {
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
  void forAllBesideObstacles(Visit visit) {
    for (const core::Polygon& obstacle : obstacles_) {
      for (std::size_t i = 0; i < agents_.size(); ++i) {
        const double distance_m = core::distanceTo(obstacle, agents_[i].position_world_m);
        record_.noteGap(distance_m - agents_[i].radius_m);
        visit(i, distance_m);
      }
    }
  }

  const Rules& rules_;
  std::span<const core::Polygon> obstacles_;
  Crew crew_;
  std::span<const std::unique_ptr<planner::Policy>> policies_;
  std::vector<planner::shield::Shield> shields_;  // of every agent, whether it is asked or not
  std::vector<planner::shield::Neighbour> neighbours_;
  EpisodeRecord record_;
  std::vector<core::EgoAgent> agents_;
  std::vector<double> time_left_s_;  // until an agent counts as stuck
  std::vector<core::OtherAgent> around_;
  std::vector<core::OtherAgent> others_;
  std::vector<Action> actions_;
  sim::Lidar lidar_{config::Lidar()};
  std::vector<sim::Disc> discs_;
  const EpisodeRecord::PositionOf position_of_ = [this](std::size_t i) {
    return agents_[i].position_world_m;
  };
};

}  // namespace

EpisodeResult runIdealEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew,
                              Trace* trace) {
  IdealEpisode episode(rules, test_case, crew, trace);
  flyLegs(test_case, episode.record(),
          [&](std::span<const Vector2d> goals_m) { episode.fly(goals_m); });
  return episode.record().result();
}

}  // namespace roundabout::learning
