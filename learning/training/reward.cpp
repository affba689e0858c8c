#include "learning/training/reward.h"

namespace roundabout::learning {

double rewardOf(const StepOutcome& outcome, double planning_step_s, double collision_reward) {
  constexpr double kNear_m = 0.2;
  if (outcome.collided || outcome.gap_m <= 0.0) {
    return collision_reward;
  }
  if (outcome.at_goal) {
    return 1.0;
  }
  return outcome.gap_m < kNear_m ? (-0.1 + 0.5 * outcome.gap_m) * planning_step_s / kRewardStep_s
                                 : 0.0;
}

}  // namespace roundabout::learning
