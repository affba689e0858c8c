// What every message type has to stand: bytes that are not, or no longer, a message.

#include "common/bus/typed.h"

#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/core/random.h"
#include "tests/common/bus/sample_messages.h"

namespace roundabout::bus {
namespace {

using Bytes = std::vector<std::byte>;

void setCount(Bytes& bytes, std::size_t offset, std::uint32_t count) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[offset + i] = static_cast<std::byte>(count >> (8 * (3 - i)));
  }
}

template <class Message>
class TypedDecode : public testing::Test {
 protected:
  const Bytes valid_ = encode(sample<Message>());
  Message message_{};
};

using AllTypes = testing::Types<roundabout_msgs::vehicle_states_t, roundabout_msgs::command_t,
                                roundabout_msgs::goal_t, roundabout_msgs::safety_order_t,
                                roundabout_msgs::mission_t, roundabout_msgs::planner_status_t,
                                roundabout_msgs::fleet_status_t, roundabout_msgs::planar_lidar_t,
                                roundabout_msgs::agent_tracks_t, roundabout_msgs::image_t,
                                roundabout_msgs::occupancy_t, roundabout_msgs::odometry_t>;
class TypeName {
 public:
  template <class Message>
  static std::string GetName(int) {  // NOLINT(readability-identifier-naming): GoogleTest's name
    return Message::getTypeName();
  }
};
TYPED_TEST_SUITE(TypedDecode, AllTypes, TypeName);

TYPED_TEST(TypedDecode, AWholeMessageComesBackTheSame) {
  EXPECT_EQ(decode(this->valid_, this->message_), nullptr);
  EXPECT_EQ(encode(this->message_), this->valid_);
}

TYPED_TEST(TypedDecode, TruncatedAtAnyByteIsRefused) {
  for (std::size_t size = 0; size < this->valid_.size(); ++size) {
    const std::span<const std::byte> part(this->valid_.data(), size);
    // A copy of just that size, so that a sanitizer sees a read past its end.
    const Bytes bytes(part.begin(), part.end());
    EXPECT_NE(decode(bytes, this->message_), nullptr) << size;
  }
}

TYPED_TEST(TypedDecode, BytesLeftOverAreRefused) {
  Bytes bytes = this->valid_;
  bytes.push_back(std::byte{0});
  EXPECT_STREQ(decode(bytes, this->message_), "bytes left over");
}

TYPED_TEST(TypedDecode, AWrongFingerprintIsRefused) {
  for (std::size_t i = 0; i < 8; ++i) {
    Bytes bytes = this->valid_;
    bytes[i] ^= std::byte{1};
    EXPECT_STREQ(decode(bytes, this->message_), "wrong fingerprint");
  }
}

TYPED_TEST(TypedDecode, CountsThatTheMessageCannotHoldAreRefused) {
  for (const CountField& field : kCountFields<TypeParam>) {
    for (const std::uint32_t count : {0xFFFFFFFFU, 0x80000000U, 0x7FFFFFFFU, 1000000U}) {
      Bytes bytes = this->valid_;
      setCount(bytes, field.offset, count);
      EXPECT_STREQ(decode(bytes, this->message_), "counts larger than the message");
    }
  }
}

TYPED_TEST(TypedDecode, CountsThatAreOffByOneAreRefused) {
  for (const CountField& field : kCountFields<TypeParam>) {
    for (const int change : {-1, 1}) {
      Bytes bytes = this->valid_;
      const auto count = static_cast<std::uint32_t>(bigEndian(bytes, field.offset, 4));
      setCount(bytes, field.offset, count + static_cast<std::uint32_t>(change));
      EXPECT_NE(decode(bytes, this->message_), nullptr);
    }
  }
}

// Wherever a string's length stands: lcm-gen's own decode() believes a negative one.
TYPED_TEST(TypedDecode, LengthsThatNoStringHasNeverCrash) {
  for (std::size_t offset = 8; offset + 4 <= this->valid_.size(); ++offset) {
    for (const std::uint32_t length : {0x80000000U, 0x80000001U, 0xFFFFFFFFU, 0x7FFFFFFFU, 0U}) {
      Bytes bytes = this->valid_;
      setCount(bytes, offset, length);
      TypeParam message{};
      if (decode(bytes, message) == nullptr) {
        ASSERT_EQ(static_cast<std::size_t>(message.getEncodedSize()), bytes.size());
      }
    }
  }
}

TYPED_TEST(TypedDecode, FlippedBitsNeverCrash) {
  core::RandomStream random(1, TypeParam::getTypeName());
  constexpr int kTries = 20000;
  for (int i = 0; i < kTries; ++i) {
    Bytes bytes = this->valid_;
    // The fingerprint is left alone: what is behind it shall be reached.
    const std::size_t flips = 1 + random.index(4);
    for (std::size_t flip = 0; flip < flips; ++flip) {
      const std::size_t bit = 64 + random.index(8 * bytes.size() - 64);
      bytes[bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    }
    if (random.chance(0.25)) {
      bytes.resize(8 + random.index(bytes.size() - 8));
    }
    TypeParam message{};
    if (decode(bytes, message) == nullptr) {
      ASSERT_EQ(static_cast<std::size_t>(message.getEncodedSize()), bytes.size());
    }
  }
}

TYPED_TEST(TypedDecode, SubscribersHearOfMessagesAndOfErrors) {
  auto network = std::make_shared<MemoryNetwork>();
  MemoryBus sender(network);
  MemoryBus receiver(network);
  int messages = 0;
  std::vector<std::string> errors;
  subscribe<TypeParam>(
      receiver, "CHANNEL", [&](const TypeParam&) { ++messages; },
      [&](const DecodeError& error) {
        errors.push_back(std::string(error.channel) + ": " + error.reason);
      });
  publish(sender, "CHANNEL", sample<TypeParam>());
  sender.publish("CHANNEL", Bytes(3));
  sender.publish("CHANNEL", Bytes(100));
  publish(sender, "CHANNEL", sample<TypeParam>());
  receiver.handle(std::chrono::milliseconds(0));
  EXPECT_EQ(messages, 2);
  EXPECT_EQ(errors, (std::vector<std::string>{"CHANNEL: shorter than a fingerprint",
                                              "CHANNEL: wrong fingerprint"}));
}

TEST(Decode, AllocatesNoMoreThanThePayloadCanHold) {
  Bytes bytes = encode(sample<roundabout_msgs::vehicle_states_t>());
  const std::size_t offset = count_fields::kVehicleStates[0].offset;
  const std::size_t most = bytes.size() / count_fields::kVehicleStates[0].min_element_bytes;
  for (std::uint32_t count = 0; count < 100; ++count) {
    setCount(bytes, offset, count);
    roundabout_msgs::vehicle_states_t message{};
    const bool good = decode(bytes, message) == nullptr;
    EXPECT_EQ(good, count == 2);
    EXPECT_LE(message.vehicles.capacity(), most);
  }
}

TEST(Decode, BelievesNeitherCountOfALaserScan) {
  const Bytes valid = encode(sample<roundabout_msgs::planar_lidar_t>());
  const std::size_t intensities = count_fields::kPlanarLidar[0].offset + 4 + 3 * sizeof(float);
  for (const std::uint32_t count : {0xFFFFFFFFU, 0x80000000U, 0x7FFFFFFFU, 1000000U, 5U}) {
    Bytes bytes = valid;
    setCount(bytes, intensities, count);
    roundabout_msgs::planar_lidar_t message{};
    EXPECT_STREQ(decode(bytes, message), "counts larger than the message");
    EXPECT_EQ(message.intensities.capacity(), 0U);
  }
}

TEST(Decode, BelievesNoCountOfAnImage) {
  const Bytes valid = encode(sample<roundabout_msgs::image_t>());
  const std::size_t entries = count_fields::kImage[0].offset + 4 + 5;
  const std::size_t key = entries + 4;
  const std::size_t value = key + 4 + sizeof("exposure");
  ASSERT_EQ(value + 4 + 2, valid.size());
  for (const std::size_t offset : {entries, key, value}) {
    for (const std::uint32_t count : {0xFFFFFFFFU, 0x80000000U, 0x7FFFFFFFU, 1000000U, 17U}) {
      Bytes bytes = valid;
      setCount(bytes, offset, count);
      roundabout_msgs::image_t message{};
      EXPECT_STREQ(decode(bytes, message), "counts larger than the message") << offset;
      EXPECT_EQ(message.metadata.capacity(), 0U);
    }
  }
}

// So that tools for bot_core.image_t read it.
TEST(Image, IsLaidOutLikeLibbot2s) {
  const Bytes bytes = encode(sample<roundabout_msgs::image_t>());
  EXPECT_EQ(bigEndian(bytes, 8, 8), 1'005'000U);
  EXPECT_EQ(bigEndian(bytes, 16, 4), 320U);         // width
  EXPECT_EQ(bigEndian(bytes, 20, 4), 240U);         // height
  EXPECT_EQ(bigEndian(bytes, 24, 4), 0U);           // row_stride
  EXPECT_EQ(bigEndian(bytes, 28, 4), 0x47504A4DU);  // pixelformat: "MJPG", last letter first
  EXPECT_EQ(bigEndian(bytes, 32, 4), 5U);           // size
  EXPECT_EQ(bigEndian(bytes, 36, 2), 0xFFD8U);      // data
  EXPECT_EQ(bigEndian(bytes, 41, 4), 1U);           // nmetadata
}

// So that tools for bot_core.planar_lidar_t read it.
TEST(PlanarLidar, IsLaidOutLikeLibbot2s) {
  const Bytes bytes = encode(sample<roundabout_msgs::planar_lidar_t>());
  ASSERT_EQ(bytes.size(), 52U);
  EXPECT_EQ(bigEndian(bytes, 8, 8), 1'005'000U);
  EXPECT_EQ(bigEndian(bytes, 16, 4), 3U);
  EXPECT_EQ(bigEndian(bytes, 32, 4), 2U);
  EXPECT_EQ(static_cast<std::uint32_t>(bigEndian(bytes, 44, 4)), 0xBFC00000U);  // rad0 = -1.5
  EXPECT_EQ(static_cast<std::uint32_t>(bigEndian(bytes, 48, 4)), 0x3FC00000U);  // radstep = 1.5
}

// The smallest element of each list is an empty one; plausible.h has its size as a number.
TEST(CountFields, KnowTheSmallestElements) {
  EXPECT_EQ(count_fields::kVehicleStates[0].min_element_bytes,
            static_cast<std::size_t>(roundabout_msgs::vehicle_state_t{}.getEncodedSize() - 8));
  EXPECT_EQ(count_fields::kFleetStatus[0].min_element_bytes,
            static_cast<std::size_t>(roundabout_msgs::vehicle_progress_t{}.getEncodedSize() - 8));
  EXPECT_EQ(count_fields::kAgentTracks[0].min_element_bytes,
            static_cast<std::size_t>(roundabout_msgs::agent_track_t{}.getEncodedSize() - 8));
}

}  // namespace
}  // namespace roundabout::bus
