#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "learning/training/environment.h"
#include "learning/training/lab_roll_out.h"
#include "learning/training/trainer.h"
#include "learning/training/workers.h"

namespace roundabout::learning {

/// Proximal policy optimisation. The same recipe and state give the same, bit for bit, with any
/// number of threads.
class PpoTrainer final : public Trainer {
 public:
  PpoTrainer(const Recipe& recipe, int threads, TrainingState state);

  IterationFigures iterate() override;
  void renewEnvironments() override;

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
  void mirrorSome();
  void normaliseAdvantages();
  void learn(IterationFigures& figures);
  LossFigures addGradient(Shard& shard, std::span<const std::uint32_t> order);
  bool update(std::span<const std::uint32_t> order, LossFigures& sum);

  Workers workers_;
  HardCases hard_cases_;
  std::deque<Shard> shards_;
  StagePlace place_{};
  std::shared_ptr<const planner::Ga3cCadrlWeights> flown_;  // in the lab
  Samples samples_;
  std::vector<bool> mirrored_;     // of samples_
  std::vector<float> advantages_;  // normalised
  std::vector<std::uint32_t> order_;
};

}  // namespace roundabout::learning
