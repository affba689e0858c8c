#include "learning/evaluation/ideal_episode.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

struct Agent {
  core::EgoAgent ego;
  double straight_time_s = 0.0;
  double time_s = 0.0;       // until it was done
  double time_left_s = 0.0;  // until it counts as stuck
  bool at_goal = false;
  bool collided = false;
  bool timed_out = false;

  bool done() const { return at_goal || collided || timed_out; }
};

/// One case, step by step, as the published environment does it.
class IdealEpisode {
 public:
  IdealEpisode(const Rules& rules, const TestCase& test_case,
               std::span<const std::unique_ptr<planner::Policy>> policies, Trace* trace)
      : rules_(rules), policies_(policies), trace_(trace) {
    for (const AgentSpec& spec : test_case.agents) {
      Agent agent;
      agent.ego.position_world_m = spec.start_m;
      agent.ego.preferred_speed_mps = spec.preferred_speed_mps;
      agent.ego.radius_m = spec.radius_m;
      const Vector2d way = spec.goal_m - spec.start_m;
      agent.ego.heading_world_rad = std::atan2(way.y(), way.x());
      agents_.push_back(agent);
    }
    around_.resize(agents_.size());
    decisions_.resize(agents_.size());
  }

  /// All begin to fly to these goals, with new clocks.
  void begin(std::span<const Vector2d> goals_m) {
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      Agent& agent = agents_[i];
      agent.ego.goal_world_m = goals_m[i];
      agent.ego.velocity_world_mps.setZero();
      agent.straight_time_s =
          ((agent.ego.position_world_m - goals_m[i]).norm() - rules_.goal_distance_m) /
          agent.ego.preferred_speed_mps;
      agent.time_left_s = rules_.time_ratio * agent.straight_time_s;
      agent.time_s = 0.0;
      agent.at_goal = agent.collided = agent.timed_out = false;
    }
    beginLeg();
    record();
    noteSeparation();
  }

  void run() {
    while (!allDone()) {
      step();
    }
    for (const Agent& agent : agents_) {
      if (agent.at_goal) {
        extra_time_s_ += agent.time_s - agent.straight_time_s;
        ++arrivals_;
      }
    }
  }

  EpisodeResult result() const {
    EpisodeResult result;
    result.outcome = outcome();
    result.steps = steps_;
    result.mean_extra_time_s =
        arrivals_ > 0 ? extra_time_s_ / arrivals_ : std::numeric_limits<double>::quiet_NaN();
    result.closest_separation_m = closest_m_;
    result.decisions = queries_;
    return result;
  }

  Outcome outcome() const {
    const auto any = [&](bool Agent::*what) {
      return std::any_of(agents_.begin(), agents_.end(),
                         [what](const Agent& agent) { return agent.*what; });
    };
    return any(&Agent::collided)    ? Outcome::kCollision
           : any(&Agent::timed_out) ? Outcome::kStuck
                                    : Outcome::kAllAtGoal;
  }

 private:
  bool allDone() const {
    return std::all_of(agents_.begin(), agents_.end(), [](const Agent& a) { return a.done(); });
  }

  void step() {
    decide();
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      move(agents_[i], decisions_[i]);
    }
    collide();
    ++steps_;
    record();
  }

  void decide() {
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      const core::EgoAgent& agent = agents_[i].ego;
      around_[i] = {agent.position_world_m, agent.velocity_world_mps, agent.radius_m,
                    static_cast<int>(i)};
    }
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      if (agents_[i].done()) {
        continue;
      }
      others_.assign(around_.begin(), around_.end());
      others_.erase(others_.begin() + static_cast<std::ptrdiff_t>(i));
      core::Surroundings around(others_);
      if (policies_[i]->needsScan()) {
        around.scan = scanOf(i);
      }
      const planner::Decision decision = policies_[i]->decide(agents_[i].ego, around);
      // The published environment passes actions on in single precision.
      decisions_[i] = {static_cast<float>(decision.speed_mps),
                       static_cast<float>(decision.heading_change_rad)};
      ++queries_;
    }
  }

  core::RangeScan scanOf(std::size_t agent) {
    discs_.clear();
    for (const core::OtherAgent& other : others_) {
      discs_.push_back({other.position_world_m, other.radius_m});
    }
    const core::EgoAgent& ego = agents_[agent].ego;
    return lidar_.sweep(ego.position_world_m, ego.heading_world_rad, {.discs = discs_});
  }

  struct Action {
    float speed_mps;
    float heading_change_rad;
  };

  void move(Agent& agent, const Action& action) const {
    core::EgoAgent& ego = agent.ego;
    if (agent.done()) {
      ego.velocity_world_mps.setZero();
      return;
    }
    const double speed_mps = action.speed_mps;
    const double heading_rad =
        wrapped(static_cast<double>(action.heading_change_rad) + ego.heading_world_rad);
    const Vector2d velocity(speed_mps * std::cos(heading_rad), speed_mps * std::sin(heading_rad));
    ego.position_world_m += velocity * rules_.planning_step_s;
    ego.velocity_world_mps = velocity;
    ego.heading_world_rad = heading_rad;
    agent.time_s += rules_.planning_step_s;
    agent.time_left_s -= rules_.planning_step_s;
    agent.at_goal = (ego.position_world_m - ego.goal_world_m).squaredNorm() <=
                    rules_.goal_distance_m * rules_.goal_distance_m;
    agent.timed_out = !agent.at_goal && agent.time_left_s <= 0.0;
  }

  void collide() {
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      for (std::size_t j = i + 1; j < agents_.size(); ++j) {
        Agent& a = agents_[i];
        Agent& b = agents_[j];
        const double distance_m = (a.ego.position_world_m - b.ego.position_world_m).norm();
        const double radii_m = a.ego.radius_m + b.ego.radius_m;
        closest_m_ = std::min(closest_m_, distance_m - radii_m);
        if (distance_m <= rules_.body_share * radii_m) {
          a.collided = !a.at_goal;
          b.collided = !b.at_goal;
        }
      }
    }
  }

  void noteSeparation() {
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      for (std::size_t j = i + 1; j < agents_.size(); ++j) {
        closest_m_ = std::min(
            closest_m_, (agents_[i].ego.position_world_m - agents_[j].ego.position_world_m).norm() -
                            agents_[i].ego.radius_m - agents_[j].ego.radius_m);
      }
    }
  }

  void beginLeg() {
    if (trace_ != nullptr) {
      trace_->emplace_back();
    }
  }

  void record() {
    if (trace_ == nullptr) {
      return;
    }
    std::vector<TracePoint>& points = trace_->back().emplace_back();
    for (const Agent& agent : agents_) {
      points.push_back({agent.ego.position_world_m, agent.done(), agent.collided});
    }
  }

  const Rules& rules_;
  std::span<const std::unique_ptr<planner::Policy>> policies_;
  Trace* trace_;
  std::vector<Agent> agents_;
  std::vector<core::OtherAgent> around_;
  std::vector<core::OtherAgent> others_;
  std::vector<Action> decisions_;
  sim::Lidar lidar_{config::Lidar()};
  std::vector<sim::Disc> discs_;
  int steps_ = 0;
  int arrivals_ = 0;
  long queries_ = 0;
  double extra_time_s_ = 0.0;
  double closest_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace

EpisodeResult runIdealEpisode(const Rules& rules, const TestCase& test_case,
                              std::span<const std::unique_ptr<planner::Policy>> policies,
                              Trace* trace) {
  IdealEpisode episode(rules, test_case, policies, trace);
  std::vector<Vector2d> goals_m;
  for (const AgentSpec& agent : test_case.agents) {
    goals_m.push_back(agent.goal_m);
  }
  episode.begin(goals_m);
  episode.run();
  for (const std::vector<Vector2d>& next_goals_m : test_case.later_goals_m) {
    if (episode.outcome() != Outcome::kAllAtGoal) {
      break;
    }
    for (const auto& policy : policies) {
      policy->reset();
    }
    episode.begin(next_goals_m);
    episode.run();
  }
  return episode.result();
}

}  // namespace roundabout::learning
