#include "common/core/tick_timer.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace roundabout::core {
namespace {

std::vector<Utime> ticksOf(TickTimer& timer, Utime first, Utime step, Utime last) {
  std::vector<Utime> ticks;
  for (Utime utime = first; utime <= last; utime += step) {
    if (timer.due(utime)) {
      ticks.push_back(utime);
    }
  }
  return ticks;
}

TEST(Utime, RoundsToTheNearestMicrosecond) {
  EXPECT_EQ(toUtime(0.1), 100'000);
  EXPECT_EQ(toUtime(1.0 / 3.0), 333'333);
  EXPECT_EQ(toUtime(2.0 / 3.0), 666'667);
  EXPECT_EQ(toUtime(-0.005), -5'000);
  EXPECT_DOUBLE_EQ(toSeconds(1'500'000), 1.5);
}

TEST(TickTimer, TicksOnMultiplesOfThePeriod) {
  TickTimer timer(10.0);
  EXPECT_EQ(timer.periodUs(), 100'000);
  EXPECT_EQ(ticksOf(timer, 1'000'000, 5'000, 1'300'000),
            (std::vector<Utime>{1'000'000, 1'100'000, 1'200'000, 1'300'000}));
  EXPECT_EQ(timer.missed(), 0);
}

TEST(TickTimer, WhoStartsLaterTicksOnTheSameFrames) {
  TickTimer timer(10.0);
  const std::vector<Utime> ticks = ticksOf(timer, 1'035'000, 5'000, 1'300'000);
  ASSERT_EQ(ticks.size(), 4u);
  // The first frame it sees is a tick; from then on it is on the grid.
  EXPECT_EQ(ticks[0], 1'035'000);
  EXPECT_EQ(ticks[1], 1'100'000);
}

TEST(TickTimer, TwoRatesShareAGrid) {
  TickTimer planner(10.0);
  TickTimer fleet(5.0);
  for (Utime utime = 1'000'000; utime < 3'000'000; utime += 5'000) {
    const bool planner_due = planner.due(utime);
    if (fleet.due(utime)) {
      EXPECT_TRUE(planner_due) << utime;
    }
  }
}

TEST(TickTimer, TakesTheFirstFrameAfterATickWithoutAFrame) {
  TickTimer timer(10.0);
  EXPECT_TRUE(timer.due(1'000'000));
  EXPECT_FALSE(timer.due(1'095'000));
  EXPECT_TRUE(timer.due(1'103'000));
  EXPECT_FALSE(timer.due(1'108'000));
  EXPECT_EQ(timer.missed(), 0);
}

TEST(TickTimer, CountsTicksThatPassedWithoutAFrame) {
  TickTimer timer(10.0);
  EXPECT_TRUE(timer.due(1'000'000));
  EXPECT_TRUE(timer.due(1'350'000));
  EXPECT_EQ(timer.missed(), 2);
}

TEST(TickTimer, AnOldOrRepeatedFrameIsNeverATick) {
  TickTimer timer(10.0);
  EXPECT_TRUE(timer.due(1'200'000));
  EXPECT_FALSE(timer.due(1'200'000));
  EXPECT_FALSE(timer.due(1'100'000));
  EXPECT_FALSE(timer.due(0));
  EXPECT_TRUE(timer.due(1'300'000));
  EXPECT_EQ(timer.missed(), 0);
}

TEST(TickTimer, AGapOfYearsDoesNotOverflowTheCount) {
  TickTimer timer(1000.0);
  EXPECT_TRUE(timer.due(0));
  EXPECT_TRUE(timer.due(1'700'000'000'000'000));
  EXPECT_EQ(timer.missed(), std::numeric_limits<int>::max());
}

}  // namespace
}  // namespace roundabout::core
