#include "planner/policies/ga3c_cadrl/network.h"

#include <utility>

namespace roundabout::planner {

Ga3cCadrlNetwork::Ga3cCadrlNetwork(std::shared_ptr<const Ga3cCadrlWeights> weights)
    : weights_(std::move(weights)), joint_(weights_->layer1.kernel.rows()) {
  others_.reserve(static_cast<std::size_t>(weights_->max_others));
}

Ga3cCadrlNetwork::Output Ga3cCadrlNetwork::evaluate(const Observation& observation) {
  const Weights& net = *weights_;

  const Eigen::Map<const nn::Row<Weights::kEgoInputs>> ego(observation.ego.data());
  joint_.head<Weights::kEgoInputs>() = (ego - net.ego_mean).cwiseQuotient(net.ego_deviation);
  others_.clear();
  for (const OtherFeatures& features : observation.others) {
    others_.push_back(net.normalisedOther(features));
  }
  const Eigen::Index summary_size = joint_.size() - Weights::kEgoInputs;
  std::visit([&](const auto& reader) { reader.read(others_, joint_.tail(summary_size)); },
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
  return output;
}

}  // namespace roundabout::planner
