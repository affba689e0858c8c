#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "planner/nn/dense.h"
#include "planner/observation.h"
#include "planner/policies/ga3c_cadrl/actions.h"
#include "planner/policies/ga3c_cadrl/others_reader.h"

namespace roundabout::planner {

/// What is subtracted from each field of an observation, and what it is then divided by.
struct Normalisation {
  std::array<double, kEgoFields.size()> ego_mean;
  std::array<double, kEgoFields.size()> ego_deviation;
  std::array<double, kOtherFields.size()> other_mean;
  std::array<double, kOtherFields.size()> other_deviation;
};

/// That of the published networks, also used for our own.
inline constexpr Normalisation kPublishedNormalisation = {
    .ego_mean = {0.0, 0.0, 1.0, 0.5},
    .ego_deviation = {5.0, 3.14, 1.0, 1.0},
    .other_mean = {0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 1.0},
    .other_deviation = {5.0, 5.0, 1.0, 1.0, 1.0, 5.0, 1.0},
};

/// What the value head's output is to be added to.
enum class ValueBaseline {
  kNone,
  kLoneAgent,  ///< loneAgentValue()
};

/// Value of an agent that has the room to itself: the reward of 1 for arriving, discounted for the
/// time it takes on the straight line (paper, section "Learning the Policy": 0.97 for 0.2 s).
double loneAgentValue(double distance_to_goal_m, double preferred_speed_mps);

/// When an agent counts as stalled, and what it then does (StallBreaker).
struct StallSettings {
  int decisions = 40;       ///< so many without progress
  double progress_m = 0.1;  ///< nearer to the goal than ever before
  double sharpness = 0.5;   ///< probabilities to this power are drawn from
};

/// Topology and parameters of a GA3C-CADRL network (paper, section "Approach"; layer sizes are the
/// published code's): an LSTM, a shared layer or a maximum sums up the others; this summary and the
/// ego's fields pass three layers; two heads give the actions' scores and the value. Never changes
/// once loaded: agents share it.
struct Ga3cCadrlWeights {
  static constexpr int kEgoInputs = planner::kEgoInputs;
  static constexpr int kActionCount = static_cast<int>(kActions.size());
  static constexpr int kWidth = 256;

  nn::Row<kEgoInputs> ego_mean, ego_deviation;
  OtherInput other_mean, other_deviation;
  int max_others = 0;  ///< the most it was made to read
  OthersOrder others_order = OthersOrder::kClosestLast;
  ValueBaseline value_baseline = ValueBaseline::kNone;
  std::optional<StallSettings> stall;  ///< nothing: always the most probable action
  OthersReader others;
  nn::Dense<Eigen::Dynamic, kWidth> layer1;  ///< inputs: the ego, then the summary of the others
  nn::Dense<kWidth, kWidth> layer2, layer3;
  nn::Dense<kWidth, kActionCount + 1> heads;  ///< the actions' scores, then the value

  EgoInput normalisedEgo(const EgoFeatures& features) const {
    const Eigen::Map<const EgoInput> ego(features.data());
    return (ego - ego_mean).cwiseQuotient(ego_deviation);
  }

  OtherInput normalisedOther(const OtherFeatures& features) const {
    const Eigen::Map<const OtherInput> other(features.data());
    return (other - other_mean).cwiseQuotient(other_deviation);
  }
};

/// Evaluates a network on its own scratch memory. Allocates nothing.
class Ga3cCadrlNetwork {
 public:
  struct Output {
    std::span<const float> probabilities;  ///< one per action; valid until the next call
    float value = 0.0F;
    int best_action = 0;  ///< the most probable one, the first of equals
  };

  explicit Ga3cCadrlNetwork(std::shared_ptr<const Ga3cCadrlWeights> weights);

  /// At most weights()->max_others others.
  Output evaluate(const Observation& observation);

  const std::shared_ptr<const Ga3cCadrlWeights>& weights() const { return weights_; }

 private:
  using Weights = Ga3cCadrlWeights;

  std::shared_ptr<const Weights> weights_;
  std::vector<OtherInput> others_;
  nn::Row<Eigen::Dynamic> joint_;
  nn::Row<Weights::kWidth> wide_a_, wide_b_;
  nn::Row<Weights::kActionCount + 1> heads_;
  nn::Row<Weights::kActionCount> probabilities_;
};

}  // namespace roundabout::planner
