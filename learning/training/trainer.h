#pragma once

#include <memory>

#include "learning/training/adam.h"
#include "learning/training/networks.h"
#include "learning/training/ppo_loss.h"
#include "learning/training/recipe.h"

namespace roundabout::learning {

/// How a recipe has gone so far: all that has to be kept to continue.
struct TrainingState {
  explicit TrainingState(Eigen::Index size) : parameters(size), averaged(size), adam(size) {}

  Parameters parameters;
  Parameters averaged;  ///< running mean: the network to be judged and flown
  Adam adam;
  long iterations = 0;
  long agent_steps = 0;
  long episodes = 0;
};

/// What an iteration was like: means over samples and finished episodes.
struct IterationFigures {
  std::size_t samples = 0;
  std::size_t episodes = 0;
  double reward = 0.0;   ///< of an episode
  double success = 0.0;  ///< share of episodes
  LossFigures loss;
  double learning_rate = 0.0;
  bool cut_short = false;  ///< the policy moved too far
};

/// One algorithm at work on a recipe.
class Trainer {
 public:
  virtual ~Trainer() = default;

  /// Gathers experience and learns from it, for a second or so.
  virtual IterationFigures iterate() = 0;
  /// All environments begin new episodes, with random numbers that depend on the number of
  /// iterations alone. A state continues exactly from here.
  virtual void renewEnvironments() = 0;

  const TrainingState& state() const { return state_; }
  const NetworkPlan& plan() const { return plan_; }
  const ParameterLayout& layout() const { return layout_; }

 protected:
  Trainer(const Recipe& recipe, TrainingState state);

  /// Throws core::StartupError if training has diverged, before a checkpoint is lost to it.
  void expectFinite(double gradient_norm) const;

  const Recipe recipe_;
  const NetworkPlan plan_;
  const ParameterLayout layout_;
  TrainingState state_;
};

/// With which a recipe begins.
TrainingState initialState(const Recipe& recipe);

/// The algorithm that the recipe says, from a state of the same recipe. threads: of the processor.
std::unique_ptr<Trainer> makeTrainer(const Recipe& recipe, int threads, TrainingState state);

}  // namespace roundabout::learning
