#include "planner/policies/ga3c_cadrl/stall_breaker.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "planner/policies/ga3c_cadrl/actions.h"

namespace roundabout::planner {
namespace {

constexpr int kStop = 9;
constexpr int kAhead = 2;

// An agent that prefers to stand, and would rather go ahead than anything else.
class Stalled : public ::testing::Test {
 protected:
  Stalled() {
    probabilities_.fill(0.01F);
    probabilities_[kStop] = 0.6F;
    probabilities_[kAhead] = 0.3F;
    ego_.goal_world_m = {5.0, 0.0};
  }

  int choose() { return breaker_.choose(ego_, probabilities_, kStop); }

  std::vector<int> choose(int times) {
    std::vector<int> chosen;
    for (int i = 0; i < times; ++i) {
      chosen.push_back(choose());
    }
    return chosen;
  }

  std::array<float, kActions.size()> probabilities_{};
  core::EgoAgent ego_;
  StallBreaker breaker_{StallSettings{}};
};

TEST_F(Stalled, TakesTheMostProbableActionForFourSeconds) {
  EXPECT_EQ(choose(40), std::vector<int>(40, kStop));
}

TEST_F(Stalled, ThenDrawsAndNeverStandsStill) {
  choose(40);
  int ahead = 0;
  for (const int action : choose(1000)) {
    EXPECT_NE(action, kStop);
    ahead += action == kAhead ? 1 : 0;
  }
  // sqrt(0.3) of sqrt(0.3) + 9 sqrt(0.01)
  EXPECT_NEAR(ahead, 1000.0 * 0.5477 / (0.5477 + 0.9), 60.0);
}

TEST_F(Stalled, ObeysTheNetworkAgainAfterProgress) {
  choose(60);
  ego_.position_world_m.x() += 0.11;
  EXPECT_EQ(choose(40), std::vector<int>(40, kStop));
}

TEST_F(Stalled, ForgetsWithAReset) {
  choose(60);
  breaker_.reset();
  EXPECT_EQ(choose(40), std::vector<int>(40, kStop));
}

TEST_F(Stalled, IsNoProgressToBeSentElsewhere) {
  int drawn = 0;
  for (int i = 0; i < 60; ++i) {
    ego_.goal_world_m = {5.0, i % 2 == 0 ? 1.0 : -1.0};
    drawn += choose() == kStop ? 0 : 1;
  }
  EXPECT_EQ(drawn, 20);
}

TEST_F(Stalled, GetsOnAlongAWayWhosePlacesChange) {
  ego_.way_left_m = 12.0;
  for (int i = 0; i < 200; ++i) {
    ego_.way_left_m -= 0.05;
    ego_.position_world_m.y() += 0.05;
    ego_.goal_world_m = {1.0, 0.05 * i};  // as far away as ever
    ASSERT_EQ(choose(), kStop) << i;
  }
}

TEST_F(Stalled, GivesALongerWayThatItFindsAChance) {
  ego_.way_left_m = 2.0;
  choose(30);
  ego_.way_left_m = 9.0;  // the first was a dead end
  int drawn = 0;
  for (int i = 0; i < 60; ++i) {
    ego_.way_left_m -= 0.05;
    drawn += choose() == kStop ? 0 : 1;
  }
  EXPECT_EQ(drawn, 0);
}

TEST_F(Stalled, DrawsTheSameAgainFromTheSamePlaceAndOthersFromAnother) {
  const std::vector<int> first = choose(200);
  breaker_.reset();
  EXPECT_EQ(choose(200), first);
  breaker_.reset();
  ego_.position_world_m.y() = 1e-9;
  EXPECT_NE(choose(200), first);
}

}  // namespace
}  // namespace roundabout::planner
