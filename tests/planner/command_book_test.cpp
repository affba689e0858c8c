#include "planner/safety/command_book.h"

#include <gtest/gtest.h>

#include "tests/planner/fake_flight.h"

namespace roundabout::planner {
namespace {

class CommandBookTest : public ::testing::Test {
 protected:
  const char* offer(const std::string& vehicle, core::Utime utime) {
    core::Command command;
    command.vehicle = vehicle;
    command.utime = utime;
    return book_.offer(command, newest_frame_);
  }

  CommandBook book_{threeVehicles()};
  core::Utime newest_frame_ = 1'000'000;
};

TEST_F(CommandBookTest, ACommandTakesEffectAtTheFirstTickAfterItsTime) {
  EXPECT_EQ(offer("hex2", 1'000'000), nullptr);
  EXPECT_TRUE(book_.apply(1'000'000).empty());
  EXPECT_EQ(book_.latest(1), nullptr);
  ASSERT_EQ(book_.apply(1'100'000).size(), 1u);
  ASSERT_NE(book_.latest(1), nullptr);
  EXPECT_TRUE(book_.apply(1'200'000).empty()) << "once";
  EXPECT_NE(book_.latest(1), nullptr) << "it stays the latest";
}

TEST_F(CommandBookTest, TheOrderOfArrivalChangesNothing) {
  offer("hex3", 1'020'000);
  offer("hex2", 1'000'000);
  offer("hex2", 1'020'000);
  const auto applied = book_.apply(1'100'000);
  ASSERT_EQ(applied.size(), 3u);
  EXPECT_EQ(applied[0].vehicle, 1u);
  EXPECT_EQ(applied[0].command.utime, 1'000'000);
  EXPECT_EQ(applied[1].vehicle, 1u);
  EXPECT_EQ(applied[2].vehicle, 2u);
}

TEST_F(CommandBookTest, RefusesWhatIsOldUnknownOrFromTheFuture) {
  EXPECT_EQ(offer("hex2", 1'000'000), nullptr);
  EXPECT_STREQ(offer("hex2", 999'999), "older than the command before");
  EXPECT_EQ(offer("hex3", 999'999), nullptr) << "each vehicle has a time of its own";
  EXPECT_STREQ(offer("hex9", 1'000'000), "of a vehicle that the experiment does not have");
  EXPECT_STREQ(offer("hex2", 2'000'001), "more than a second ahead of the newest states");
  EXPECT_STREQ(offer("hex2", -1), "its time stamp is corrupt");
}

TEST_F(CommandBookTest, KeepsTheNewestFewUntilTheNextTick) {
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(offer("hex2", 1'000'000 + i), nullptr);
  }
  const auto applied = book_.apply(1'100'000);
  ASSERT_EQ(applied.size(), 8u);
  EXPECT_EQ(applied.front().command.utime, 1'000'992);
  EXPECT_EQ(applied.back().command.utime, 1'000'999);
}

TEST_F(CommandBookTest, ForgetsEverythingWhenANewEpochBegins) {
  offer("hex2", 1'000'000);
  book_.apply(1'100'000);
  book_.clear();
  newest_frame_ = 100'000;
  EXPECT_EQ(book_.latest(1), nullptr);
  EXPECT_EQ(offer("hex2", 100'000), nullptr);
}

}  // namespace
}  // namespace roundabout::planner
