#include "learning/evaluation/ideal_episode.h"

#include <cmath>

#include "learning/evaluation/ideal_world.h"
#include "sim/sensors/lidar.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

// The published environment passes actions on in single precision.
IdealAction actionOf(double speed_mps, double heading_change_rad) {
  return {static_cast<float>(speed_mps), static_cast<float>(heading_change_rad)};
}

planner::shield::Motion motionOf(const core::EgoAgent& agent) {
  planner::shield::Motion motion;
  motion.position_world_m = agent.position_world_m;
  motion.velocity_world_mps = agent.velocity_world_mps;
  motion.heading_world_rad = agent.heading_world_rad;
  return motion;
}

/// One case, step by step: policies, and shields round some of them, in an ideal world.
class IdealEpisode {
 public:
  IdealEpisode(const Rules& rules, const TestCase& test_case, const Crew& crew, Trace* trace)
      : rules_(rules),
        obstacles_(test_case.obstacles),
        crew_(crew),
        world_(rules, test_case, trace),
        actions_(test_case.agents.size()) {
    for (const auto& policy : crew_.policies) {
      planner::shield::ShieldParameters parameters =
          planner::shield::ShieldParameters::idealRules();
      parameters.period_s = parameters.hold_s = rules.planning_step_s;
      parameters.suit(policy->name());
      shields_.emplace_back(parameters);
    }
  }

  void fly(std::span<const Vector2d> goals_m) {
    world_.beginLeg(goals_m);
    for (std::size_t i = 0; i < world_.size(); ++i) {
      crew_.policies[i]->reset();
      shields_[i].reset();
    }
    while (!world_.record().allDone()) {
      decide();
      world_.step(actions_);
    }
    world_.endLeg();
  }

  const EpisodeRecord& record() const { return world_.record(); }

 private:
  void decide() {
    for (std::size_t i = 0; i < world_.size(); ++i) {
      if (world_.done(i)) {
        continue;
      }
      planner::Policy& policy = *crew_.policies[i];
      core::Surroundings around(world_.othersOf(i));
      around.obstacles = obstacles_;
      if (policy.needsScan()) {
        around.scan = scanOf(world_.agent(i), around.others);
      }
      const planner::Decision decision = policy.decide(world_.agent(i), around);
      actions_[i] = actionOf(decision.speed_mps, decision.heading_change_rad);
      world_.record().noteDecision();
      if (crew_.isShielded(i)) {
        shield(i);
      }
    }
  }

  void shield(std::size_t i) {
    const core::EgoAgent& agent = world_.agent(i);
    planner::shield::Ego ego;
    ego.motion = motionOf(agent);
    ego.radius_m = rules_.body_share * agent.radius_m;
    ego.goal_world_m = agent.goal_world_m;
    ego.preferred_speed_mps = ego.max_speed_mps = agent.preferred_speed_mps;
    ego.id = static_cast<int>(i);
    collectNeighbours(i);
    const Vector2d wanted = velocityOf(actions_[i], agent.heading_world_rad);
    const planner::shield::ShieldDecision decision = shields_[i].decide(
        ego, neighbours_, {.obstacles = obstacles_}, wanted, world_.record()[i].time_s);
    world_.record().noteLayer(decision.layer);
    const Vector2d& flown = decision.velocity_world_mps;
    if (flown == wanted) {
      return;
    }
    const double speed_mps = flown.norm();
    const double across = wanted.x() * flown.y() - wanted.y() * flown.x();
    if (speed_mps > 0.0 &&
        (wanted.dot(flown) <= 0.0 || std::abs(across) > 1e-9 * wanted.norm() * speed_mps)) {
      const double course_rad = std::atan2(flown.y(), flown.x());
      actions_[i] = actionOf(speed_mps, wrappedOnce(course_rad - agent.heading_world_rad));
    } else {
      actions_[i] = actionOf(speed_mps, static_cast<double>(actions_[i].heading_change_rad));
    }
  }

  void collectNeighbours(std::size_t i) {
    neighbours_.clear();
    for (std::size_t j = 0; j < world_.size(); ++j) {
      if (j == i) {
        continue;
      }
      const core::EgoAgent& agent = world_.agent(j);
      planner::shield::Neighbour& other = neighbours_.emplace_back();
      other.motion = motionOf(agent);
      other.radius_m = rules_.body_share * agent.radius_m;
      other.max_speed_mps = agent.preferred_speed_mps;
      other.id = static_cast<int>(j);
      other.shielded = crew_.isShielded(j);
      other.parked = world_.done(j);
    }
  }

  core::RangeScan scanOf(const core::EgoAgent& ego, std::span<const core::OtherAgent> others) {
    discs_.clear();
    for (const core::OtherAgent& other : others) {
      discs_.push_back({other.position_world_m, other.radius_m});
    }
    return lidar_.sweep(ego.position_world_m, ego.heading_world_rad,
                        {.discs = discs_, .polygons = obstacles_});
  }

  const Rules& rules_;
  std::span<const core::Polygon> obstacles_;
  Crew crew_;
  IdealWorld world_;
  std::vector<planner::shield::Shield> shields_;  // of every agent, whether it is asked or not
  std::vector<planner::shield::Neighbour> neighbours_;
  std::vector<IdealAction> actions_;
  sim::Lidar lidar_{config::Lidar()};
  std::vector<sim::Disc> discs_;
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
