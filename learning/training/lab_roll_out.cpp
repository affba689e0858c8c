#include "learning/training/lab_roll_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "learning/training/reward.h"
#include "learning/training/scores.h"
#include "planner/policies/ga3c_cadrl/actions.h"
#include "planner/policies/non_cooperative/non_cooperative.h"
#include "planner/policies/static/static.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

constexpr double kTimeRatio = 2.0;
constexpr double kTimeAllowance_s = 8.0;

/// What one learner saw and did. Shared by a policy and its twin that flies.
struct Diary {
  Samples samples;
  std::vector<double> potentials;
};

/// Acts by chance, as the network weighs its actions, and keeps a diary.
class Learner final : public planner::Policy {
 public:
  Learner(std::shared_ptr<const planner::Ga3cCadrlWeights> weights, float sharpness,
          core::RandomStream& random, std::shared_ptr<Diary> diary)
      : weights_(std::move(weights)),
        sharpness_(sharpness),
        random_(random),
        diary_(std::move(diary)),
        encoder_(weights_->max_others, weights_->others_order),
        network_(weights_) {}

  planner::Decision decide(const core::EgoAgent& ego, const core::Surroundings& around) override {
    const planner::Observation& observation = encoder_.encode(ego, around.others);
    const planner::Ga3cCadrlNetwork::Output output = network_.evaluate(observation);
    Eigen::Matrix<float, 1, kActionCount> scores;
    for (int a = 0; a < kActionCount; ++a) {
      scores[a] = std::log(std::max(output.probabilities[static_cast<std::size_t>(a)], 1e-30F));
    }
    const Scores log_probabilities = logProbabilities(scores, sharpness_);
    const int action = drawAction(log_probabilities, random_.uniform(0.0, 1.0));
    const double potential = weights_->value_baseline == planner::ValueBaseline::kLoneAgent
                                 ? planner::loneAgentValue(observation.ego[0], observation.ego[2])
                                 : 0.0;

    const std::size_t sample = diary_->samples.add(observation);
    diary_->samples.action[sample] = static_cast<std::uint8_t>(action);
    diary_->samples.sharpness[sample] = sharpness_;
    diary_->samples.log_probability[sample] = log_probabilities[action];
    diary_->samples.value[sample] = output.value - static_cast<float>(potential);
    diary_->potentials.push_back(potential);

    const planner::DiscreteAction& chosen = planner::kActions[static_cast<std::size_t>(action)];
    planner::Decision decision;
    decision.speed_mps = chosen.speed_fraction * ego.preferred_speed_mps;
    decision.heading_change_rad = chosen.heading_change_rad;
    decision.action = action;
    return decision;
  }

  std::unique_ptr<Policy> twin() const override {
    return std::make_unique<Learner>(weights_, sharpness_, random_, diary_);
  }

  std::string_view name() const override { return "learner"; }

 private:
  std::shared_ptr<const planner::Ga3cCadrlWeights> weights_;
  float sharpness_;
  core::RandomStream& random_;
  std::shared_ptr<Diary> diary_;
  planner::ObservationEncoder encoder_;
  planner::Ga3cCadrlNetwork network_;
};

double gapAt(const std::vector<TracePoint>& points, const TestCase& test_case, std::size_t agent) {
  double gap_m = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (j != agent) {
      gap_m = std::min(gap_m, (points[j].position_m - points[agent].position_m).norm() -
                                  test_case.agents[j].radius_m - test_case.agents[agent].radius_m);
    }
  }
  return gap_m;
}

}  // namespace

LabRollOut::LabRollOut(const Recipe& recipe, core::RandomStream random)
    : recipe_(recipe), random_(std::move(random)) {}

Rules LabRollOut::drawRules(const Stage& stage) {
  Rules rules = makeRules("lab");
  rules.time_ratio = kTimeRatio;
  rules.time_allowance_s = kTimeAllowance_s;
  rules.planning_step_s = stage.planning_step_s;
  const auto vary = [&](double& quantity) {
    quantity *= random_.uniform(1.0 - stage.lab_variation, 1.0 + stage.lab_variation);
  };
  vary(rules.sim.multirotor.velocity_gain_per_s);
  vary(rules.sim.multirotor.attitude_time_constant_s);
  vary(rules.sim.multirotor.yaw_gain_per_s);
  vary(rules.sim.multirotor.max_acceleration_mps2);
  vary(rules.sim.multirotor.command_delay_s);
  vary(rules.sim.mocap.position_noise_m);
  return rules;
}

void LabRollOut::run(const Stage& stage, double collision_reward,
                     const std::shared_ptr<const planner::Ga3cCadrlWeights>& network,
                     Samples& samples) {
  const TrainingCase drawn = drawTrainingCase(stage, recipe_.crowd, random_);
  const TestCase& test_case = drawn.test_case;
  const Rules rules = drawRules(stage);
  std::vector<std::shared_ptr<Diary>> diaries;
  std::vector<std::unique_ptr<planner::Policy>> crew;
  for (const Role role : drawn.roles) {
    diaries.push_back(std::make_shared<Diary>());
    if (isLearner(role)) {
      const double sharpness = role == Role::kSharpLearner ? stage.sharpness : 1.0;
      crew.push_back(std::make_unique<Learner>(network, static_cast<float>(sharpness), random_,
                                               diaries.back()));
    } else {
      crew.push_back(role == Role::kStatic ? planner::makeStatic({})
                                           : planner::makeNonCooperative({}));
    }
  }
  Trace trace;
  runEpisode(rules, test_case, {.policies = crew}, &trace);
  const Leg& leg = trace.front();

  EpisodeFigures figures{0.0, true};
  int learners = 0;
  for (std::size_t i = 0; i < crew.size(); ++i) {
    if (!isLearner(drawn.roles[i])) {
      continue;
    }
    ++learners;
    const auto done_at =
        static_cast<std::size_t>(std::find_if(leg.begin() + 1, leg.end(),
                                              [i](const auto& points) { return points[i].done; }) -
                                 leg.begin());
    const TracePoint& end = leg[std::min(done_at, leg.size() - 1)][i];
    const bool at_goal = !end.collided && (end.position_m - test_case.agents[i].goal_m).norm() <=
                                              rules.goal_distance_m;
    figures.success = figures.success && at_goal;

    // Near the goal a vehicle flies by itself: its last decision answers for what comes of it.
    Samples& own = diaries[i]->samples;
    const std::size_t count = std::min(own.size(), done_at);
    const double discount = std::pow(kDiscount, rules.planning_step_s / kRewardStep_s);
    for (std::size_t s = 0; s < count; ++s) {
      const bool last = s + 1 == count;
      const std::size_t until = last ? done_at : s + 1;
      double reward = 0.0;
      for (std::size_t step = s + 1; step <= until && step < leg.size(); ++step) {
        const bool ends = step == done_at;
        StepOutcome outcome{ends && at_goal, ends && end.collided, gapAt(leg[step], test_case, i)};
        // Bodies are smaller than what the policy sees.
        outcome.gap_m = std::max(outcome.gap_m, 1e-9);
        reward += rewardOf(outcome, rules.planning_step_s, collision_reward);
      }
      figures.reward += reward;
      const double after = last ? 0.0 : diaries[i]->potentials[s + 1];
      own.reward[s] = static_cast<float>(reward + discount * after - diaries[i]->potentials[s]);
      own.next[s] = last ? Samples::kTerminal : static_cast<std::int32_t>(s + 1);
    }
    own.truncate(count);
    samples.append(own);
  }
  figures.reward /= learners;
  finished_.push_back(figures);
}

}  // namespace roundabout::learning
