#include "mocap_bridge/state_publisher.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/error.h"

namespace roundabout::mocap_bridge {
namespace {

class StatePublisherTest : public testing::Test {
 protected:
  StatePublisherTest() {
    bus::subscribe<roundabout_msgs::vehicle_states_t>(
        bus_, bus::kStatesChannel,
        [this](const roundabout_msgs::vehicle_states_t& message) { heard_.push_back(message); },
        [](const bus::DecodeError& error) { ADD_FAILURE() << error.reason; });
    for (const char* name : {"hex1", "hex2"}) {
      core::VehicleState& state = frame_.vehicles.emplace_back();
      state.name = name;
      state.tracked = true;
    }
  }

  bool publishNext() {
    frame_.utime += 5000;
    frame_.frame_number += 1;
    return publishAgain();
  }
  bool publishAgain() {
    const bool published = publisher_.publish(frame_);
    bus_.handle(std::chrono::milliseconds(0));
    return published;
  }
  const roundabout_msgs::vehicle_state_t& first() const { return heard_.back().vehicles[0]; }
  const roundabout_msgs::vehicle_state_t& second() const { return heard_.back().vehicles[1]; }

  bus::MemoryBus bus_{std::make_shared<bus::MemoryNetwork>()};
  StatePublisher publisher_{bus_, {"hex1", "hex2"}};
  core::StatesFrame frame_{1'000'000, -1, {}};
  std::vector<roundabout_msgs::vehicle_states_t> heard_;
};

TEST_F(StatePublisherTest, PublishesWhatItIsGiven) {
  frame_.vehicles[1].position_world_m = {1.0, 2.0, 3.0};
  EXPECT_TRUE(publishNext());
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(heard_[0].utime, 1'005'000);
  EXPECT_EQ(heard_[0].frame_number, 0);
  EXPECT_EQ(second().name, "hex2");
  EXPECT_EQ(second().position[1], 2.0);
  EXPECT_EQ(second().last_seen, 1'005'000);
  EXPECT_EQ(publisher_.counters().published, 1);
}

TEST_F(StatePublisherTest, DropsAFrameOfTheSameTime) {
  publishNext();
  frame_.frame_number += 1;
  EXPECT_FALSE(publishAgain());
  EXPECT_EQ(publisher_.counters().dropped_frames, 1);
  EXPECT_EQ(heard_.size(), 1U);
}

TEST_F(StatePublisherTest, AFrameFromTheFutureDoesNotBlindTheLab) {
  publishNext();
  frame_.utime += 86'400'000'000;
  EXPECT_FALSE(publishNext());
  frame_.utime -= 86'400'000'000;
  EXPECT_TRUE(publishNext());
}

TEST_F(StatePublisherTest, ANumberFromTheFutureDoesNotBlindTheLab) {
  publishNext();
  frame_.frame_number = std::numeric_limits<std::int64_t>::max() - 1;
  EXPECT_TRUE(publishNext());
  EXPECT_EQ(heard_.back().frame_number, 1);
  frame_.frame_number = 1;
  EXPECT_TRUE(publishNext());
  EXPECT_EQ(heard_.back().frame_number, 2);
  EXPECT_TRUE(publishNext());
  EXPECT_EQ(heard_.back().frame_number, 3);
}

TEST_F(StatePublisherTest, CountsOnWhenTheSourceDoesNot) {
  publishNext();
  for (const std::int64_t number : {0L, -7L, -8L}) {
    frame_.frame_number = number;
    frame_.utime += 5000;
    EXPECT_TRUE(publishAgain());
  }
  EXPECT_EQ(heard_.back().frame_number, 3);
}

TEST_F(StatePublisherTest, BeginsWithTheSourcesNumberIfItIsOne) {
  frame_.frame_number = 123'456;
  publishNext();
  EXPECT_EQ(heard_.back().frame_number, 123'457);
  StatePublisher other(bus_, {"hex1", "hex2"});
  frame_.frame_number = std::numeric_limits<std::int64_t>::max();
  EXPECT_TRUE(other.publish(frame_));
  EXPECT_EQ(other.lastPublished().frame_number, 0);
}

TEST_F(StatePublisherTest, FramesThatTheSourceLostAreMissingInTheNumbers) {
  publishNext();
  frame_.frame_number += 2;
  frame_.utime += 10'000;
  publishNext();
  EXPECT_EQ(heard_.back().frame_number, 3);
}

TEST_F(StatePublisherTest, ASourceThatWasStartedAnewIsFollowedAndNothingOldIsShown) {
  frame_.utime = 3'600'000'000;
  publishNext();
  frame_.utime = 1'000'000;
  frame_.frame_number = -1;
  frame_.vehicles[0].tracked = false;
  frame_.vehicles[0].position_world_m.x() = 5.0;
  for (int k = 0; k < 9; ++k) {
    EXPECT_FALSE(publishNext());
  }
  EXPECT_TRUE(publishNext());
  EXPECT_EQ(heard_.back().utime, 1'050'000);
  EXPECT_EQ(heard_.back().frame_number, 1);
  EXPECT_EQ(first().last_seen, 0) << "not later than the frame";
  EXPECT_EQ(second().last_seen, 1'050'000);
}

TEST_F(StatePublisherTest, GoesOnAfterADroppedFrame) {
  publishNext();
  frame_.utime -= 10'000;
  EXPECT_FALSE(publishAgain());
  frame_.utime += 20'000;
  EXPECT_TRUE(publishNext());
}

TEST_F(StatePublisherTest, DropsAFrameWithOtherVehicles) {
  std::swap(frame_.vehicles[0].name, frame_.vehicles[1].name);
  EXPECT_FALSE(publishNext());
  frame_.vehicles.pop_back();
  EXPECT_FALSE(publishNext());
  EXPECT_EQ(publisher_.counters().dropped_frames, 2);
  EXPECT_TRUE(heard_.empty());
}

TEST_F(StatePublisherTest, KeepsTheLastEstimateAndLastSeenOfAHiddenVehicle) {
  frame_.vehicles[0].position_world_m.x() = 1.0;
  publishNext();
  frame_.vehicles[0].position_world_m.x() = 9.0;
  frame_.vehicles[0].tracked = false;
  publishNext();
  EXPECT_FALSE(first().tracked);
  EXPECT_EQ(first().position[0], 1.0);
  EXPECT_EQ(first().last_seen, 1'005'000);
  EXPECT_EQ(second().last_seen, 1'010'000);
  EXPECT_EQ(publisher_.counters().rejected_states, 0);
}

TEST_F(StatePublisherTest, APredictionIsShownAsSuchAndItsAgeStays) {
  publishNext();
  frame_.vehicles[0].tracked = false;
  frame_.vehicles[0].predicted = true;
  frame_.vehicles[0].position_world_m.x() = 3.0;
  publishNext();
  EXPECT_FALSE(first().tracked);
  EXPECT_TRUE(first().predicted);
  EXPECT_EQ(first().position[0], 3.0);
  EXPECT_EQ(first().last_seen, 1'005'000);
  EXPECT_FALSE(second().predicted);
}

TEST_F(StatePublisherTest, ResampledStatesSayTheExposureAndWereSeenThen) {
  frame_.exposure_utime = 1'002'000;
  publishNext();
  EXPECT_EQ(heard_.back().exposure_utime, 1'002'000);
  EXPECT_EQ(first().last_seen, 1'002'000);
  frame_.exposure_utime = 9'000'000;
  publishNext();
  EXPECT_EQ(heard_.back().exposure_utime, heard_.back().utime) << "no exposure in the future";
}

TEST_F(StatePublisherTest, AVehicleThatWasNeverSeenShowsZeros) {
  frame_.vehicles[0].position_world_m.x() = 9.0;
  frame_.vehicles[0].tracked = false;
  publishNext();
  EXPECT_EQ(first().last_seen, 0);
  EXPECT_EQ(first().position[0], 0.0);
  EXPECT_EQ(first().orientation[0], 1.0);
}

TEST_F(StatePublisherTest, ANumberThatIsNotFiniteHidesOnlyItsVehicle) {
  frame_.vehicles[0].velocity_world_mps.y() = std::numeric_limits<double>::infinity();
  frame_.vehicles[1].position_world_m.x() = 2.0;
  EXPECT_TRUE(publishNext());
  EXPECT_FALSE(first().tracked);
  EXPECT_EQ(first().velocity[1], 0.0);
  EXPECT_TRUE(second().tracked);
  EXPECT_EQ(publisher_.counters().rejected_states, 1);
}

TEST_F(StatePublisherTest, NormalisesARoundedQuaternion) {
  frame_.vehicles[0].orientation.coeffs() *= 1.001;
  publishNext();
  EXPECT_TRUE(first().tracked);
  EXPECT_EQ(first().orientation[0], 1.0);
}

TEST_F(StatePublisherTest, RejectsWhatIsNotARotation) {
  frame_.vehicles[0].orientation.coeffs().setZero();
  publishNext();
  EXPECT_FALSE(first().tracked);
  EXPECT_EQ(publisher_.counters().rejected_states, 1);
}

/// Somebody publishes while one listens.
class LabWithPublisher final : public bus::Bus {
 public:
  explicit LabWithPublisher(std::string channel) : channel_(std::move(channel)) {}
  void publish(const std::string&, std::span<const std::byte>) override {}
  void subscribe(const std::string& channel, Handler handler) override {
    if (channel == channel_) {
      handler_ = std::move(handler);
    }
  }
  void subscribePrefix(const std::string&, Handler) override {}
  int handle(std::chrono::milliseconds) override {
    if (!handler_) {
      return 0;
    }
    handler_({channel_, {}, 0});
    return 1;
  }

 private:
  std::string channel_;
  Handler handler_;
};

TEST(SolePublisher, HearsSomebodyElse) {
  LabWithPublisher lab("VEHICLE_STATES");
  EXPECT_TRUE(somebodyElsePublishes(lab, std::chrono::milliseconds(1)));
}

TEST(SolePublisher, HearsNobodyInAnEmptyLab) {
  LabWithPublisher lab("FLEET_STATUS");
  EXPECT_FALSE(somebodyElsePublishes(lab, std::chrono::milliseconds(1)));
}

TEST(SolePublisher, RefusesToBeTheSecondAndNamesTheUrl) {
  LabWithPublisher lab("VEHICLE_STATES");
  EXPECT_THAT(
      [&] { requireSolePublisher(lab, "udpm://239.255.76.67:7667", std::chrono::milliseconds(1)); },
      testing::ThrowsMessage<core::StartupError>(
          "lcm_url: VEHICLE_STATES: expected no other publisher, found VEHICLE_STATES is already "
          "published on udpm://239.255.76.67:7667"));
}

}  // namespace
}  // namespace roundabout::mocap_bridge
