#include "learning/training/environment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "learning/training/reward.h"
#include "learning/training/scores.h"
#include "planner/policies/ga3c_cadrl/actions.h"
#include "planner/policies/ga3c_cadrl/network.h"
#include "planner/policies/non_cooperative/non_cooperative.h"

namespace roundabout::learning {

namespace {

// Longer than the paper's, which is twice the straight-line time: to go round somebody who stands
// in the way of a short path takes that and more.
constexpr double kTimeRatio = 2.0;
constexpr double kTimeAllowance_s = 5.0;

}  // namespace

Environment::Environment(const Recipe& recipe, core::RandomStream random,
                         const HardCases* hard_cases)
    : recipe_(recipe),
      random_(std::move(random)),
      hard_cases_(hard_cases),
      rules_(makeRules("published")),
      straight_(planner::makeNonCooperative({})),
      encoder_(recipe.max_others, planner::othersOrderNamed(recipe.others_order).value()) {
  rules_.time_ratio = kTimeRatio;
  rules_.time_allowance_s = kTimeAllowance_s;
}

void Environment::enter(const Stage& stage, double collision_reward) {
  stage_ = &stage;
  collision_reward_ = collision_reward;
  rules_.planning_step_s = stage.planning_step_s;
  if (!world_) {
    begin();
  }
}

void Environment::begin() {
  const bool again = stage_->hard_share > 0.0 && hard_cases_ != nullptr &&
                     hard_cases_->worthDrawing() && random_.chance(stage_->hard_share);
  case_ = again ? hard_cases_->draw(random_) : drawTrainingCase(*stage_, recipe_.crowd, random_);
  world_.emplace(rules_, case_.test_case);
  std::vector<Eigen::Vector2d> goals_m;
  for (const AgentSpec& agent : case_.test_case.agents) {
    goals_m.push_back(agent.goal_m);
  }
  world_->beginLeg(goals_m);
  actions_.assign(world_->size(), {});
  learners_.assign(world_->size(), {});
}

void Environment::beginSamples() {
  for (Learner& learner : learners_) {
    learner.sample = kNone;
    learner.previous = kNone;
  }
}

double Environment::potentialOf(std::size_t i) const {
  if (!recipe_.potential) {
    return 0.0;
  }
  const core::EgoAgent& agent = world_->agent(i);
  return planner::loneAgentValue((agent.goal_world_m - agent.position_world_m).norm(),
                                 agent.preferred_speed_mps);
}

void Environment::observe(Samples& samples) {
  for (std::size_t i = 0; i < world_->size(); ++i) {
    if (!underWay(i)) {
      continue;
    }
    Learner& learner = learners_[i];
    const std::size_t sample = samples.add(encoder_.encode(world_->agent(i), world_->othersOf(i)));
    learner.sample = static_cast<std::int32_t>(sample);
    learner.potential = potentialOf(i);
    if (learner.previous != kNone) {
      samples.next[static_cast<std::size_t>(learner.previous)] = learner.sample;
    }
  }
}

void Environment::choose(Samples& samples, const Eigen::Ref<const Matrix>& heads,
                         std::size_t first_sample) {
  for (std::size_t i = 0; i < world_->size(); ++i) {
    if (!underWay(i)) {
      continue;
    }
    const auto sample = static_cast<std::size_t>(learners_[i].sample);
    const auto row = heads.row(static_cast<Eigen::Index>(sample - first_sample));
    const bool sharp = case_.roles[i] == Role::kSharpLearner;
    samples.sharpness[sample] = sharp ? static_cast<float>(stage_->sharpness) : 1.0F;
    const Scores log_probabilities =
        logProbabilities(row.head<kActionCount>(), samples.sharpness[sample]);
    const int action = drawAction(log_probabilities, random_.uniform(0.0, 1.0));
    samples.action[sample] = static_cast<std::uint8_t>(action);
    samples.log_probability[sample] = log_probabilities[action];
    samples.value[sample] = row[kActionCount];
    const planner::DiscreteAction& chosen = planner::kActions[static_cast<std::size_t>(action)];
    actions_[i] = {static_cast<float>(chosen.speed_fraction * world_->agent(i).preferred_speed_mps),
                   static_cast<float>(chosen.heading_change_rad)};
  }
}

void Environment::step(Samples& samples) {
  for (std::size_t i = 0; i < world_->size(); ++i) {
    if (case_.roles[i] == Role::kNonCooperative && !world_->done(i)) {
      const planner::Decision decision =
          straight_->decide(world_->agent(i), std::span<const core::OtherAgent>());
      actions_[i] = {static_cast<float>(decision.speed_mps),
                     static_cast<float>(decision.heading_change_rad)};
    }
    learners_[i].previous = underWay(i) ? learners_[i].sample : kNone;
  }
  world_->step(actions_);
  bool all_done = true;
  for (std::size_t i = 0; i < world_->size(); ++i) {
    if (learners_[i].previous != kNone) {
      reward(samples, i);
    }
    all_done = all_done && !underWay(i);
  }
  if (all_done) {
    finish();
    begin();
  }
}

double Environment::gapOf(std::size_t i) const {
  const core::EgoAgent& agent = world_->agent(i);
  double gap_m = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < world_->size(); ++j) {
    if (j != i) {
      const core::EgoAgent& other = world_->agent(j);
      gap_m = std::min(gap_m, (agent.position_world_m - other.position_world_m).norm() -
                                  agent.radius_m - other.radius_m);
    }
  }
  return gap_m;
}

void Environment::reward(Samples& samples, std::size_t i) {
  Learner& learner = learners_[i];
  const EpisodeRecord::Agent& agent = world_->record()[i];
  const double reward = rewardOf({agent.at_goal, agent.collided, gapOf(i)}, rules_.planning_step_s,
                                 collision_reward_);
  learner.reward += reward;
  learner.success = reward >= 1.0;
  const auto sample = static_cast<std::size_t>(learner.previous);
  // Shaped by the potential (Ng et al. 1999), which is 0 once the episode has ended.
  const double after = agent.done() ? 0.0 : potentialOf(i);
  const double discount = std::pow(kDiscount, rules_.planning_step_s / kRewardStep_s);
  samples.reward[sample] = static_cast<float>(reward + discount * after - learner.potential);
  samples.next[sample] = agent.done() ? Samples::kTerminal : Samples::kCutOff;
}

void Environment::finish() {
  EpisodeFigures figures{0.0, true};
  int learners = 0;
  for (std::size_t i = 0; i < learners_.size(); ++i) {
    if (isLearner(case_.roles[i])) {
      figures.reward += learners_[i].reward;
      figures.success = figures.success && learners_[i].success;
      ++learners;
    }
  }
  figures.reward /= learners;
  finished_.push_back(figures);
  if (!figures.success && stage_->hard_share > 0.0) {
    failed_.push_back(case_);
  }
}

void Environment::lookBeyond(Samples& beyond, std::vector<std::size_t>& last_samples) {
  for (std::size_t i = 0; i < world_->size(); ++i) {
    if (underWay(i) && learners_[i].previous != kNone) {
      beyond.add(encoder_.encode(world_->agent(i), world_->othersOf(i)));
      last_samples.push_back(static_cast<std::size_t>(learners_[i].previous));
    }
  }
}

}  // namespace roundabout::learning
