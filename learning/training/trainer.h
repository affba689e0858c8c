#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "learning/training/adam.h"
#include "learning/training/environment.h"
#include "learning/training/lab_roll_out.h"
#include "learning/training/networks.h"
#include "learning/training/ppo_loss.h"
#include "learning/training/workers.h"

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

/// Proximal policy optimisation. The same recipe and state give the same, bit for bit, with any
/// number of threads.
class Trainer {
 public:
  /// From scratch.
  Trainer(const Recipe& recipe, int threads);
  /// From a state of the same recipe.
  Trainer(const Recipe& recipe, int threads, TrainingState state);

  IterationFigures iterate();
  /// All environments begin new episodes, with random numbers that depend on the number of
  /// iterations alone. A state continues exactly from here.
  void renewEnvironments();

  const TrainingState& state() const { return state_; }
  const NetworkPlan& plan() const { return plan_; }
  const ParameterLayout& layout() const { return layout_; }

 private:
  /// A part of the environments, and of every batch.
  struct Shard {
    Shard(const NetworkPlan& plan, Eigen::Index parameters);

    std::deque<Environment> environments;  ///< they do not move
    std::optional<LabRollOut> lab;
    Samples samples;
    Samples beyond;
    std::vector<std::size_t> last_samples;
    Batch batch;
    std::unique_ptr<TrainableNetwork> network;
    Matrix d_heads;
    Parameters gradient;
    LossFigures figures;
  };

  void rollOut(Shard& shard);
  void stepEnvironments(Shard& shard);
  void flyInTheLab(Shard& shard);
  void collect(IterationFigures& figures);
  void normaliseAdvantages();
  void learn(IterationFigures& figures);
  LossFigures addGradient(Shard& shard, std::span<const std::uint32_t> order);
  bool update(std::span<const std::uint32_t> order, LossFigures& sum);

  const Recipe recipe_;
  NetworkPlan plan_;
  ParameterLayout layout_;
  TrainingState state_;
  Workers workers_;
  std::deque<Shard> shards_;
  StagePlace place_{};
  std::shared_ptr<const planner::Ga3cCadrlWeights> flown_;  // in the lab
  Samples samples_;
  std::vector<float> advantages_;  // normalised
  std::vector<std::uint32_t> order_;
};

}  // namespace roundabout::learning
