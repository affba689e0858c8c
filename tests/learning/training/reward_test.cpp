#include "learning/training/reward.h"

#include <gtest/gtest.h>

namespace roundabout::learning {
namespace {

TEST(Reward, IsThePapers) {
  EXPECT_EQ(rewardOf({.at_goal = true, .gap_m = 1.0}, 0.2, -0.25), 1.0);
  EXPECT_EQ(rewardOf({.collided = true, .gap_m = -0.1}, 0.2, -0.25), -0.25);
  EXPECT_EQ(rewardOf({.gap_m = 0.2}, 0.2, -0.25), 0.0);
  EXPECT_NEAR(rewardOf({.gap_m = 0.1}, 0.2, -0.25), -0.05, 1e-12);
  EXPECT_NEAR(rewardOf({.gap_m = 1e-9}, 0.2, -0.25), -0.1, 1e-9);
}

TEST(Reward, OfBeingNearCountsForTheTimeThatItLasts) {
  EXPECT_NEAR(rewardOf({.gap_m = 0.1}, 0.1, -0.25), -0.025, 1e-12);
}

TEST(Reward, KnowsNoArrivalOnTopOfSomebody) {
  EXPECT_EQ(rewardOf({.at_goal = true, .gap_m = -0.01}, 0.2, -0.3), -0.3);
}

}  // namespace
}  // namespace roundabout::learning
