#include "logs/live/channel_monitor.h"

#include <gtest/gtest.h>

namespace roundabout::logs {
namespace {

class ChannelMonitorTest : public testing::Test {
 protected:
  void hear(const std::string& channel, core::Utime now, std::size_t bytes = 100) {
    monitor_.see(channel, std::vector<std::byte>(bytes, std::byte{1}), now);
  }

  ChannelMonitor monitor_;
};

TEST_F(ChannelMonitorTest, MeasuresASteadyChannel) {
  for (int i = 0; i <= 2000; ++i) {
    hear("VEHICLE_STATES", 5'000 * i, 800);
  }
  const auto states = monitor_.states(10'050'000);
  ASSERT_EQ(states.size(), 1u);
  EXPECT_EQ(states[0].messages, 2001u);
  EXPECT_NEAR(states[0].rate_hz, 200.0, 1e-6);
  EXPECT_NEAR(states[0].bytes_per_s, 160'000.0, 1e-3);
  EXPECT_NEAR(states[0].age_s, 0.05, 1e-9);
  EXPECT_NEAR(states[0].jitter_s, 0.0, 1e-9);
  EXPECT_EQ(states[0].gaps, 0u);
  EXPECT_EQ(states[0].fingerprint, 0x0101010101010101u);
}

TEST_F(ChannelMonitorTest, CountsGapsAndJitter) {
  core::Utime now = 0;
  for (int i = 0; i < 400; ++i) {
    now += i == 300 ? 50'000 : i % 10 == 0 ? 12'000 : 10'000;
    hear("A", now);
  }
  const auto states = monitor_.states(now);
  EXPECT_EQ(states[0].gaps, 1u);
  EXPECT_NEAR(states[0].jitter_s, 0.002, 1e-6);
}

TEST_F(ChannelMonitorTest, ASilentChannelHasAnAgeAndNoRate) {
  hear("ONCE", 0);
  for (int i = 0; i < 10; ++i) {
    hear("STOPPED", 100'000 * i, 2);
  }
  const auto states = monitor_.states(20'000'000);
  EXPECT_EQ(states[0].channel, "ONCE");
  EXPECT_EQ(states[0].rate_hz, 0.0);
  EXPECT_NEAR(states[1].age_s, 19.1, 1e-9);
  EXPECT_EQ(states[1].rate_hz, 0.0);
  EXPECT_EQ(states[1].fingerprint, 0u);
}

TEST_F(ChannelMonitorTest, KeepsTheLastMessage) {
  hear("A", 0, 10);
  hear("A", 1, 20);
  EXPECT_EQ(monitor_.last("A").size(), 20u);
  EXPECT_TRUE(monitor_.last("B").empty());
}

}  // namespace
}  // namespace roundabout::logs
