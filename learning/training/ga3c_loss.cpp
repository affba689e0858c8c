#include "learning/training/ga3c_loss.h"

namespace roundabout::learning {

LossFigures ga3cLoss(double entropy_weight, int action, float target,
                     const Eigen::Ref<const HeadsRow>& heads, Eigen::Ref<HeadsRow> d_heads) {
  const Scores log_probabilities = logProbabilities(heads.head<kActionCount>(), 1.0F);
  const Scores probabilities = log_probabilities.exp();
  const float entropy = -(probabilities * log_probabilities).sum();
  const float error = target - heads[kActionCount];
  Scores d_scores = error * probabilities;
  d_scores[action] -= error;
  d_scores += static_cast<float>(entropy_weight) * probabilities * (log_probabilities + entropy);
  d_heads.head<kActionCount>() = d_scores.matrix();
  d_heads[kActionCount] = -error;
  return {.divergence = 0.0,
          .entropy = entropy,
          .clipped = 0.0,
          .value_error = static_cast<double>(error * error)};
}

}  // namespace roundabout::learning
