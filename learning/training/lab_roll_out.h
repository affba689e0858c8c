#pragma once

#include <memory>
#include <vector>

#include "common/core/random.h"
#include "learning/training/environment.h"
#include "planner/policies/ga3c_cadrl/network.h"

namespace roundabout::learning {

/// Whole episodes in the lab of the evaluation: multirotors, motion capture, a planner's core each.
/// What a network is trained for real vehicles on; latency, noise and the vehicles' answer to
/// commands differ from episode to episode.
class LabRollOut {
 public:
  /// Draws from its own stream. recipe outlives it.
  LabRollOut(const Recipe& recipe, core::RandomStream random);

  /// Runs one episode in which learners fly `network`, and adds their samples, whole.
  void run(const Stage& stage, double collision_reward,
           const std::shared_ptr<const planner::Ga3cCadrlWeights>& network, Samples& samples);

  /// Episodes that have ended since the last call.
  std::vector<EpisodeFigures> takeFinished() { return std::exchange(finished_, {}); }

 private:
  Rules drawRules(const Stage& stage);

  const Recipe& recipe_;
  core::RandomStream random_;
  std::vector<EpisodeFigures> finished_;
};

}  // namespace roundabout::learning
