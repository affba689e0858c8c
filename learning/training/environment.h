#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "learning/evaluation/ideal_world.h"
#include "learning/training/matrix.h"
#include "learning/training/recipe.h"
#include "learning/training/samples.h"
#include "learning/training/training_cases.h"
#include "planner/observation.h"
#include "planner/policy.h"

namespace roundabout::learning {

/// How an episode went for its learners.
struct EpisodeFigures {
  double reward = 0.0;  ///< the paper's, summed over the episode; mean over learners
  bool success = false;
};

/// One episode after the other, in the world of the evaluation. Learners observe and act through
/// samples; all others have policies of their own.
class Environment {
 public:
  /// Draws from its own stream. recipe and hard_cases outlive it; hard_cases, which may be null,
  /// does not change while environments step.
  Environment(const Recipe& recipe, core::RandomStream random,
              const HardCases* hard_cases = nullptr);

  /// From now on; takes effect at the next episode but for the planning step.
  void enter(const Stage& stage, double collision_reward);

  /// New samples begin: what learners did before is not in them.
  void beginSamples();
  /// Adds a sample for every learner that is under way, and makes that of its step before point to
  /// it.
  void observe(Samples& samples);
  /// Draws an action for each learner that was just observed. heads: a row of scores for every
  /// sample from first_sample on, and the value after the scores.
  void choose(Samples& samples, const Eigen::Ref<const Matrix>& heads, std::size_t first_sample);
  /// Everybody moves; rewards are filled in. When all learners are done a new episode begins.
  void step(Samples& samples);
  /// What learners under way see after the last step, and their last samples.
  void lookBeyond(Samples& beyond, std::vector<std::size_t>& last_samples);

  /// Episodes that have ended since the last call.
  std::vector<EpisodeFigures> takeFinished() { return std::exchange(finished_, {}); }
  /// Those of them in which a learner failed, if the stage wants them again.
  std::vector<TrainingCase> takeFailed() { return std::exchange(failed_, {}); }

 private:
  static constexpr std::int32_t kNone = -1;

  struct Learner {
    std::int32_t sample = kNone;    // of this step
    std::int32_t previous = kNone;  // of the step before
    double potential = 0.0;
    double reward = 0.0;  // of the episode
    bool success = false;
  };

  void begin();
  bool underWay(std::size_t i) const { return isLearner(case_.roles[i]) && !world_->done(i); }
  double potentialOf(std::size_t i) const;
  double gapOf(std::size_t i) const;
  void reward(Samples& samples, std::size_t i);
  void finish();

  const Recipe& recipe_;
  core::RandomStream random_;
  const HardCases* hard_cases_;
  const Stage* stage_ = nullptr;
  double collision_reward_ = -0.25;
  Rules rules_;
  TrainingCase case_;
  std::optional<IdealWorld> world_;
  std::vector<IdealAction> actions_;
  std::vector<Learner> learners_;
  std::unique_ptr<planner::Policy> straight_;
  planner::ObservationEncoder encoder_;
  std::vector<EpisodeFigures> finished_;
  std::vector<TrainingCase> failed_;
};

}  // namespace roundabout::learning
