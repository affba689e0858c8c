#include "planner/policies/ga3c_cadrl/network.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace roundabout::planner {

double loneAgentValue(double distance_to_goal_m, double preferred_speed_mps) {
  constexpr double kDiscount = 0.97;
  constexpr double kDiscountTime_s = 0.2;
  constexpr double kArrived_m = 0.2;
  const double time_s = std::max(distance_to_goal_m - kArrived_m, 0.0) / preferred_speed_mps;
  return std::pow(kDiscount, time_s / kDiscountTime_s);
}

Ga3cCadrlNetwork::Ga3cCadrlNetwork(std::shared_ptr<const Ga3cCadrlWeights> weights)
    : weights_(std::move(weights)), joint_(weights_->layer1.kernel.rows()) {
  others_.reserve(static_cast<std::size_t>(weights_->max_others));
}

Ga3cCadrlNetwork::Output Ga3cCadrlNetwork::evaluate(const Observation& observation) {
  const Weights& net = *weights_;

  const EgoInput ego = net.normalisedEgo(observation.ego);
  joint_.head<Weights::kEgoInputs>() = ego;
  others_.clear();
  for (const OtherFeatures& features : observation.others) {
    others_.push_back(net.normalisedOther(features));
  }
  const Eigen::Index summary_size = joint_.size() - Weights::kEgoInputs;
  std::visit([&](const auto& reader) { reader.read(ego, others_, joint_.tail(summary_size)); },
             net.others);

  net.layer1.applyRelu(joint_, wide_a_);
  net.layer2.applyRelu(wide_a_, wide_b_);
  net.layer3.applyRelu(wide_b_, wide_a_);
  net.heads.apply(wide_a_, heads_);

  const auto scores = heads_.head<Weights::kActionCount>();
  Output output;
  const float best_score = scores.maxCoeff(&output.best_action);
  probabilities_ = (scores.array() - best_score).exp();
  probabilities_ /= probabilities_.sum();
  output.probabilities = {probabilities_.data(), static_cast<std::size_t>(probabilities_.size())};
  output.value = heads_[Weights::kActionCount];
  if (net.value_baseline == ValueBaseline::kLoneAgent) {
    output.value += static_cast<float>(loneAgentValue(observation.ego[0], observation.ego[2]));
  }
  return output;
}

}  // namespace roundabout::planner
