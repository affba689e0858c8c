#include "learning/training/ppo_loss.h"

#include <cmath>

namespace roundabout::learning {

LossFigures& LossFigures::operator+=(const LossFigures& more) {
  divergence += more.divergence;
  entropy += more.entropy;
  clipped += more.clipped;
  value_error += more.value_error;
  return *this;
}

LossFigures ppoLoss(const Ppo& ppo, double entropy_weight, const Samples& samples,
                    std::size_t sample, float advantage, const Eigen::Ref<const HeadsRow>& heads,
                    Eigen::Ref<HeadsRow> d_heads) {
  const float sharpness = samples.sharpness[sample];
  const Scores log_probabilities = logProbabilities(heads.head<kActionCount>(), sharpness);
  const Scores probabilities = log_probabilities.exp();
  const int action = samples.action[sample];
  const float log_ratio = log_probabilities[action] - samples.log_probability[sample];
  const float ratio = std::exp(log_ratio);
  const float entropy = -(probabilities * log_probabilities).sum();

  const auto clip = static_cast<float>(ppo.clip);
  const bool clipped = advantage > 0.0F ? ratio > 1.0F + clip : ratio < 1.0F - clip;
  const float push = clipped ? 0.0F : -advantage * ratio;
  Scores d_scores = -push * probabilities;
  d_scores[action] += push;
  d_scores += static_cast<float>(entropy_weight) * probabilities * (log_probabilities + entropy);
  const float error = heads[kActionCount] - samples.target[sample];
  d_heads.head<kActionCount>() = (sharpness * d_scores).matrix();
  d_heads[kActionCount] = static_cast<float>(ppo.value_weight) * error;

  return {.divergence = static_cast<double>(ratio - 1.0F - log_ratio),
          .entropy = entropy,
          .clipped = clipped ? 1.0 : 0.0,
          .value_error = static_cast<double>(error * error)};
}

}  // namespace roundabout::learning
