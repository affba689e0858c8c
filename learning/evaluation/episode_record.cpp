#include "learning/evaluation/episode_record.h"

#include <algorithm>

namespace roundabout::learning {

EpisodeRecord::EpisodeRecord(const Rules& rules, const TestCase& test_case, Trace* trace)
    : rules_(rules), test_case_(test_case), trace_(trace), agents_(test_case.agents.size()) {}

void EpisodeRecord::beginLeg(std::span<const Eigen::Vector2d> goals_m,
                             const PositionOf& position_of) {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    agents_[i] = {};
    agents_[i].straight_time_s = ((position_of(i) - goals_m[i]).norm() - rules_.goal_distance_m) /
                                 test_case_.agents[i].preferred_speed_mps;
  }
  if (trace_ != nullptr) {
    trace_->emplace_back();
  }
  trace(position_of);
}

void EpisodeRecord::endStep(const PositionOf& position_of) {
  ++steps_;
  trace(position_of);
}

void EpisodeRecord::endLeg() {
  for (const Agent& agent : agents_) {
    if (agent.at_goal) {
      extra_time_s_ += agent.time_s - agent.straight_time_s;
      ++arrivals_;
    }
  }
}

void EpisodeRecord::trace(const PositionOf& position_of) {
  if (trace_ == nullptr) {
    return;
  }
  std::vector<TracePoint>& points = trace_->back().emplace_back();
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    points.push_back({position_of(i), agents_[i].done(), agents_[i].collided});
  }
}

bool EpisodeRecord::allDone() const {
  return std::all_of(agents_.begin(), agents_.end(), [](const Agent& a) { return a.done(); });
}

Outcome EpisodeRecord::outcome() const {
  const auto any = [&](bool Agent::*what) {
    return std::any_of(agents_.begin(), agents_.end(),
                       [what](const Agent& agent) { return agent.*what; });
  };
  return any(&Agent::collided)    ? Outcome::kCollision
         : any(&Agent::timed_out) ? Outcome::kStuck
                                  : Outcome::kAllAtGoal;
}

EpisodeResult EpisodeRecord::result() const {
  EpisodeResult result;
  result.outcome = outcome();
  result.steps = steps_;
  result.mean_extra_time_s =
      arrivals_ > 0 ? extra_time_s_ / arrivals_ : std::numeric_limits<double>::quiet_NaN();
  result.closest_separation_m = closest_m_;
  result.decisions = decisions_;
  result.layers = layers_;
  return result;
}

void flyLegs(const TestCase& test_case, const EpisodeRecord& record,
             const std::function<void(std::span<const Eigen::Vector2d> goals_m)>& fly) {
  std::vector<Eigen::Vector2d> goals_m;
  for (const AgentSpec& agent : test_case.agents) {
    goals_m.push_back(agent.goal_m);
  }
  fly(goals_m);
  for (const std::vector<Eigen::Vector2d>& next_goals_m : test_case.later_goals_m) {
    if (record.outcome() != Outcome::kAllAtGoal) {
      return;
    }
    fly(next_goals_m);
  }
}

}  // namespace roundabout::learning
