#pragma once

#include "learning/training/ppo_loss.h"

namespace roundabout::learning {

/// The loss of A3C for one sample, as mit-acl/rl_collision_avoidance sums it over a batch:
/// -log p(action) (target - value) - entropy_weight * entropy + (target - value)^2 / 2, where the
/// first term does not reach the value. Writes its gradient by the heads. target: the return.
LossFigures ga3cLoss(double entropy_weight, int action, float target,
                     const Eigen::Ref<const HeadsRow>& heads, Eigen::Ref<HeadsRow> d_heads);

}  // namespace roundabout::learning
