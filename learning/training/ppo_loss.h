#pragma once

#include "learning/training/recipe.h"
#include "learning/training/samples.h"
#include "learning/training/scores.h"

namespace roundabout::learning {

/// What one sample adds to the figures of an update.
struct LossFigures {
  double divergence = 0.0;  ///< estimate of KL(old policy, new policy)
  double entropy = 0.0;
  double clipped = 0.0;
  double value_error = 0.0;  ///< squared

  LossFigures& operator+=(const LossFigures& more);
};

using HeadsRow = Eigen::Matrix<float, 1, kHeads>;

/// The loss of proximal policy optimisation for one sample: clipped surrogate, squared error of the
/// value, entropy. Writes its gradient by the heads.
/// advantage: normalised. Learners that act on sharpened scores learn as the policy that they are.
LossFigures ppoLoss(const Ppo& ppo, double entropy_weight, const Samples& samples,
                    std::size_t sample, float advantage, const Eigen::Ref<const HeadsRow>& heads,
                    Eigen::Ref<HeadsRow> d_heads);

}  // namespace roundabout::learning
