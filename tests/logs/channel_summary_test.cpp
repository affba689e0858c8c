#include "logs/reading/channel_summary.h"

#include <gmock/gmock.h>

#include "logs/files.h"
#include "tests/logs/log_writer.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::HasSubstr;

class ChannelSummaryTest : public testing::Test {
 protected:
  ChannelSummaryTest() {
    SyntheticFlight flight;
    flight.wall_clock_per_data = 1.0;
    flight.lost_frames = {503, 504, 505};
    flight.vehicles = {{"hex1", standing({0, 0, 1})}};
    flight.write(log());
  }
  std::string log() const { return folder_.file("flight.lcm"); }

  test::ScratchFolder folder_;
};

TEST_F(ChannelSummaryTest, NamesTypesAndMeasuresRates) {
  const auto channels = summarizeChannels(EventLog(log()), TypeTable());
  ASSERT_EQ(channels.size(), 4u);
  EXPECT_EQ(channels[0].channel, "COMMAND_hex1");
  EXPECT_EQ(channels[0].type, "command_t");
  EXPECT_NEAR(channels[0].rate_hz, 10.0, 1e-6);
  const ChannelSummary& states = channels[3];
  EXPECT_EQ(states.type, "vehicle_states_t");
  EXPECT_EQ(states.messages, 2001 - 3);
  EXPECT_DOUBLE_EQ(states.median_interval_s, 0.005);
  EXPECT_EQ(states.gaps, 1);
  EXPECT_NEAR(states.longest_gap_s, 0.020, 1e-9);
  EXPECT_NEAR(states.jitter_s.p99, 0.0, 1e-9);
}

TEST_F(ChannelSummaryTest, TellsWhereTheLogIsDamaged) {
  std::string bytes = readFile(log());
  bytes.insert(0, "not part of it");
  writeFile(log(), bytes);
  const std::string text = describe(EventLog(log()), TypeTable());
  EXPECT_THAT(text, HasSubstr("damaged in 1 places, 14 bytes skipped"));
  EXPECT_THAT(text, HasSubstr("at byte 0: 14 bytes skipped, no sync word"));
}

TEST_F(ChannelSummaryTest, SaysSoWhenAChannelHoldsSeveralTypes) {
  {
    LogWriter writer(log());
    writer.write(1, "A", roundabout_msgs::mission_t{});
    writer.write(2, "A", roundabout_msgs::planner_status_t{});
    writer.writeBytes(3, "B", std::as_bytes(std::span("0123456")));
    writer.writeBytes(4, "C", std::as_bytes(std::span("abc")));
  }
  const auto channels = summarizeChannels(EventLog(log()), TypeTable());
  EXPECT_EQ(channels[0].type, "mixed");
  EXPECT_EQ(channels[1].type, "3031323334353600");
  EXPECT_EQ(channels[2].type, "too short");
}

}  // namespace
}  // namespace roundabout::logs
