#pragma once

#include <Eigen/Core>

#include "planner/policies/ga3c_cadrl/actions.h"

namespace roundabout::learning {

inline constexpr int kActionCount = static_cast<int>(planner::kActions.size());
/// The scores, and the value after them.
inline constexpr int kHeads = kActionCount + 1;

using Scores = Eigen::Array<float, 1, kActionCount>;

/// log softmax(sharpness * scores)
inline Scores logProbabilities(
    const Eigen::Ref<const Eigen::Matrix<float, 1, kActionCount>>& scores, float sharpness) {
  Scores sharpened = sharpness * scores.array();
  sharpened -= sharpened.maxCoeff();
  sharpened -= std::log(sharpened.exp().sum());
  return sharpened;
}

/// The action that a number from [0, 1) draws.
inline int drawAction(const Scores& log_probabilities, double draw) {
  double sum = 0.0;
  for (int action = 0; action + 1 < kActionCount; ++action) {
    sum += std::exp(static_cast<double>(log_probabilities[action]));
    if (draw < sum) {
      return action;
    }
  }
  return kActionCount - 1;
}

}  // namespace roundabout::learning
