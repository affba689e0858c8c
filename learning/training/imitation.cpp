#include "learning/training/imitation.h"

#include <cmath>
#include <limits>
#include <memory>

#include "learning/evaluation/ideal_world.h"
#include "learning/training/adam.h"
#include "learning/training/networks.h"
#include "learning/training/reward.h"
#include "learning/training/scores.h"
#include "learning/training/training_cases.h"
#include "planner/observation.h"
#include "planner/policies/orca/orca.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

Rules demonstrationRules(const Stage& stage) {
  Rules rules = makeRules("published");
  rules.planning_step_s = stage.planning_step_s;
  return rules;
}

/// By the velocities, in units of the preferred speed.
std::uint8_t nearestAction(double speed_fraction, double heading_change_rad) {
  const auto velocity = [](double speed, double angle_rad) {
    return Vector2d(speed * std::cos(angle_rad), speed * std::sin(angle_rad));
  };
  const Vector2d flown = velocity(speed_fraction, heading_change_rad);
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < planner::kActions.size(); ++i) {
    const planner::DiscreteAction& action = planner::kActions[i];
    const double off = (velocity(action.speed_fraction, action.heading_change_rad) - flown).norm();
    if (off < least) {
      least = off;
      nearest = i;
    }
  }
  return static_cast<std::uint8_t>(nearest);
}

/// One agent of an episode.
struct Demonstrator {
  std::unique_ptr<planner::Policy> policy;
  Samples samples;
  std::vector<double> potentials;
};

void addWorthOfEnd(const EpisodeRecord::Agent& agent, double discount, Demonstrator& demonstrator,
                   Samples& all) {
  if (!agent.at_goal && !agent.collided) {
    return;  // nobody learns from who got stuck
  }
  constexpr double kCollision = -0.25;
  Samples& own = demonstrator.samples;
  for (std::size_t s = 0; s < own.size(); ++s) {
    const double worth = (agent.collided ? kCollision : 1.0) *
                         std::pow(discount, static_cast<double>(own.size() - 1 - s));
    own.target[s] = static_cast<float>(worth - demonstrator.potentials[s]);
  }
  all.append(own);
}

void demonstrate(const Recipe& recipe, core::RandomStream& random, Samples& all) {
  const Stage& stage = recipe.stages.front();
  const Crowd everybody{.non_cooperative_share = 0.0, .static_share = 0.0};
  Stage open = stage;
  open.trap_share = 0.0;
  const TestCase test_case = drawTrainingCase(open, everybody, random).test_case;
  const Rules rules = demonstrationRules(stage);
  IdealWorld world(rules, test_case);
  std::vector<Vector2d> goals_m;
  for (const AgentSpec& agent : test_case.agents) {
    goals_m.push_back(agent.goal_m);
  }
  world.beginLeg(goals_m);
  std::vector<Demonstrator> demonstrators(world.size());
  for (Demonstrator& each : demonstrators) {
    each.policy = planner::makeOrca({});
  }
  planner::ObservationEncoder encoder(recipe.max_others,
                                      planner::othersOrderNamed(recipe.others_order).value());
  std::vector<IdealAction> actions(world.size());
  for (bool under_way = true; under_way;) {
    under_way = false;
    for (std::size_t i = 0; i < world.size(); ++i) {
      if (world.done(i)) {
        continue;
      }
      under_way = true;
      const core::EgoAgent& ego = world.agent(i);
      const auto others = world.othersOf(i);
      Demonstrator& each = demonstrators[i];
      const planner::Decision decision = each.policy->decide(ego, others);
      const std::size_t sample = each.samples.add(encoder.encode(ego, others));
      each.samples.action[sample] =
          nearestAction(decision.speed_mps / ego.preferred_speed_mps, decision.heading_change_rad);
      each.potentials.push_back(
          recipe.potential
              ? planner::loneAgentValue((ego.goal_world_m - ego.position_world_m).norm(),
                                        ego.preferred_speed_mps)
              : 0.0);
      actions[i] = {static_cast<float>(decision.speed_mps),
                    static_cast<float>(decision.heading_change_rad)};
    }
    world.step(actions);
  }
  const double discount = std::pow(kDiscount, rules.planning_step_s / kRewardStep_s);
  for (std::size_t i = 0; i < world.size(); ++i) {
    addWorthOfEnd(world.record()[i], discount, demonstrators[i], all);
  }
}

}  // namespace

Samples gatherDemonstrations(const Recipe& recipe) {
  core::RandomStream random(recipe.seed, "training/demonstrations");
  Samples all;
  for (int i = 0; i < recipe.imitation.cases; ++i) {
    demonstrate(recipe, random, all);
  }
  return all;
}

double imitate(const Recipe& recipe, const Samples& demonstrations, Parameters& parameters) {
  const auto network = makeNetwork(networkPlan(recipe));
  core::RandomStream random(recipe.seed, "training/imitation");
  Adam adam(parameters.size());
  Parameters gradient(parameters.size());
  Batch batch;
  Matrix d_heads;
  const auto share = 1.0F / static_cast<float>(recipe.imitation.batch);
  const int last_tenth = recipe.imitation.updates - (recipe.imitation.updates + 9) / 10;
  double loss = 0.0;
  for (int update = 0; update < recipe.imitation.updates; ++update) {
    batch.clear();
    std::vector<std::size_t> drawn;
    for (int k = 0; k < recipe.imitation.batch; ++k) {
      const std::size_t s = random.index(demonstrations.size());
      drawn.push_back(s);
      batch.add(demonstrations.ego[s], demonstrations.othersOf(s));
    }
    const Matrix& heads = network->forward(parameters, batch);
    d_heads.resize(heads.rows(), kHeads);
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const int action = demonstrations.action[drawn[k]];
      const Scores log_probabilities = logProbabilities(heads.row(row).head<kActionCount>(), 1.0F);
      const float error = heads(row, kActionCount) - demonstrations.target[drawn[k]];
      d_heads.row(row).head<kActionCount>() = share * log_probabilities.exp().matrix();
      d_heads(row, action) -= share;
      d_heads(row, kActionCount) = share * 2.0F * error;
      if (update >= last_tenth) {
        loss += static_cast<double>(share * (error * error - log_probabilities[action]));
      }
    }
    gradient.setZero();
    network->backward(parameters, batch, d_heads, gradient);
    adam.update(gradient, recipe.imitation.learning_rate, parameters);
  }
  return loss / (recipe.imitation.updates - last_tenth);
}

}  // namespace roundabout::learning
