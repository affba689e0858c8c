#include "logs/reading/event_log.h"

#include <cstring>
#include <vector>

#include <gmock/gmock.h>

#include "common/core/error.h"
#include "common/core/random.h"
#include "logs/files.h"
#include "tests/logs/log_writer.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A log of ten events whose payloads say which they are; every event has 50 + its index bytes.
class EventLogTest : public testing::Test {
 protected:
  static constexpr int kEvents = 10;

  EventLogTest() {
    LogWriter writer(file());
    for (int i = 0; i < kEvents; ++i) {
      const std::vector<std::byte> payload(static_cast<std::size_t>(12 + i), std::byte(i));
      writer.writeBytes(1000 * i, "CHANNEL_" + std::string(1, static_cast<char>('a' + i)) + "x",
                        payload);
    }
  }

  std::string file() const { return folder_.file("log"); }

  static std::size_t offsetOf(int event) {
    std::size_t offset = 0;
    for (int i = 0; i < event; ++i) {
      offset += bytesOf(i);
    }
    return offset;
  }
  static std::size_t bytesOf(int event) {
    return kHeaderBytes + 10 + 12 + static_cast<std::size_t>(event);
  }

  std::string content() const { return readFile(file()); }

  static EventScan scan(const std::string& bytes) {
    return scanEvents(std::as_bytes(std::span(bytes)));
  }

  /// Which of the ten events are found, by their payload.
  static std::vector<int> found(const std::string& bytes) {
    std::vector<int> events;
    const auto log = std::as_bytes(std::span(bytes));
    for (const std::size_t offset : scanEvents(log).offsets) {
      events.push_back(std::to_integer<int>(eventAt(log, offset).payload[0]));
    }
    return events;
  }

  test::ScratchFolder folder_;
};

TEST_F(EventLogTest, ReadsWhatLcmWrote) {
  const EventLog log(file());
  ASSERT_EQ(log.size(), 10u);
  EXPECT_TRUE(log.damage().empty());
  int index = 0;
  for (const Event& event : log) {
    EXPECT_EQ(event.number, index);
    EXPECT_EQ(event.log_utime, 1000 * index);
    EXPECT_EQ(event.channel, std::string("CHANNEL_") + static_cast<char>('a' + index) + "x");
    ASSERT_EQ(event.payload.size(), static_cast<std::size_t>(12 + index));
    EXPECT_EQ(std::to_integer<int>(event.payload.back()), index);
    ++index;
  }
  EXPECT_EQ(index, 10);
}

TEST_F(EventLogTest, SkipsForeignBytesBetweenEvents) {
  std::string bytes = content();
  bytes.insert(offsetOf(4), "thirteen byte");
  EXPECT_THAT(found(bytes), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
  const DamageReport damage = scan(bytes).damage;
  ASSERT_EQ(damage.places.size(), 1u);
  EXPECT_EQ(damage.places[0].offset, offsetOf(4));
  EXPECT_EQ(damage.places[0].bytes, 13u);
  EXPECT_EQ(damage.places[0].reason, "no sync word");
}

TEST_F(EventLogTest, LosesOnlyTheEventWhoseSyncWordIsDamaged) {
  std::string bytes = content();
  bytes[offsetOf(3)] = 'x';
  EXPECT_THAT(found(bytes), ElementsAre(0, 1, 2, 4, 5, 6, 7, 8, 9));
  EXPECT_EQ(scan(bytes).damage.skippedBytes(), bytesOf(3));
}

TEST_F(EventLogTest, LosesOnlyTheEventWhoseLengthsAreDamaged) {
  for (const std::size_t field : {20u, 24u}) {
    for (const int value : {0, 1, 40, 150, 100'000, -1}) {
      std::string bytes = content();
      const auto big_endian = __builtin_bswap32(static_cast<std::uint32_t>(value));
      std::memcpy(&bytes[offsetOf(3) + field], &big_endian, 4);
      EXPECT_THAT(found(bytes), testing::IsSupersetOf({0, 1, 2, 4, 5, 6, 7, 8, 9}))
          << "length field at " << field << " set to " << value;
      EXPECT_FALSE(scan(bytes).damage.empty());
    }
  }
}

TEST_F(EventLogTest, KeepsWhatPrecedesATruncation) {
  for (const std::size_t cut : {1u, 15u, 40u}) {
    const std::string bytes = content().substr(0, offsetOf(9) + bytesOf(9) - cut);
    EXPECT_THAT(found(bytes), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
    EXPECT_EQ(scan(bytes).damage.skippedBytes(), bytesOf(9) - cut);
  }
}

TEST_F(EventLogTest, ContinuesAfterAMissingStretch) {
  std::string bytes = content();
  bytes.erase(offsetOf(2) + 20, offsetOf(6) + 5 - offsetOf(2) - 20);
  EXPECT_THAT(found(bytes), ElementsAre(0, 1, 7, 8, 9));
}

TEST_F(EventLogTest, KeepsAPayloadThatHoldsASyncWord) {
  std::string bytes = content();
  std::memcpy(&bytes[offsetOf(5) + kHeaderBytes + 12], "\xED\xA1\xDA\x01", 4);
  EXPECT_THAT(found(bytes), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
  // Even where the event after it is damaged, so that the scan has to search.
  bytes[offsetOf(6)] = 'x';
  EXPECT_THAT(found(bytes), ElementsAre(0, 1, 2, 3, 4, 5, 7, 8, 9));
}

TEST_F(EventLogTest, AccountsForEveryByteOfRandomlyDamagedLogs) {
  core::RandomStream random(1, "damage");
  const std::string whole = content();
  for (int round = 0; round < 2000; ++round) {
    std::string bytes = whole;
    for (std::size_t hits = 1 + random.index(6); hits > 0; --hits) {
      bytes[random.index(bytes.size())] = static_cast<char>(random.index(256));
    }
    const EventScan result = scan(bytes);
    std::size_t accounted = result.damage.skippedBytes();
    for (const std::size_t offset : result.offsets) {
      const Event event = eventAt(std::as_bytes(std::span(bytes)), offset);
      accounted += kHeaderBytes + event.channel.size() + event.payload.size();
    }
    ASSERT_EQ(accounted, bytes.size()) << "round " << round;
    // At most six of ten events were hit, and a hit costs no event but its own.
    ASSERT_GE(result.offsets.size(), 4u) << "round " << round;
  }
}

TEST_F(EventLogTest, RefusesWhatIsNoLogInOneLine) {
  writeFile(folder_.file("empty"), "");
  writeFile(folder_.file("text"), "name: spell_cadrl\n");
  for (const auto& [name, found] :
       std::vector<std::pair<std::string, std::string>>{{"missing", "No such file"},
                                                        {"empty", "an empty file"},
                                                        {"text", "18 bytes without one event"},
                                                        {".", "not a file"}}) {
    try {
      const EventLog log(folder_.file(name));
      FAIL() << name << " was read";
    } catch (const core::StartupError& error) {
      EXPECT_THAT(error.what(), HasSubstr(folder_.file(name)));
      EXPECT_THAT(error.what(), HasSubstr("expected an LCM event log"));
      EXPECT_THAT(error.what(), HasSubstr(found));
    }
  }
}

}  // namespace
}  // namespace roundabout::logs
