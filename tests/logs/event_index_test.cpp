#include "logs/reading/event_index.h"

#include <filesystem>
#include <vector>

#include <gmock/gmock.h>

#include "common/core/error.h"
#include "logs/files.h"
#include "logs/reading/event_log.h"
#include "tests/logs/log_writer.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

constexpr std::size_t kAlways = 1;
constexpr core::Utime kBegin = 1'000'000;
constexpr core::Utime kStep = 10'000;

void write(const std::string& file, int events, core::Utime begin = kBegin) {
  LogWriter writer(file);
  for (int i = 0; i < events; ++i) {
    const std::vector<std::byte> payload(20, std::byte(i));
    writer.writeBytes(begin + kStep * i, "CHANNEL", payload);
  }
}

class EventIndexTest : public testing::Test {
 protected:
  std::string log() const { return folder_.file("flight.lcm"); }
  std::string index() const { return indexFileOf(log()); }
  bool known() const { return readIndex(log(), MappedFile(log())).has_value(); }

  test::ScratchFolder folder_;
};

TEST_F(EventIndexTest, HoldsWhatTheScanFound) {
  write(log(), 50);
  std::string bytes = readFile(log());
  bytes[500] = 'x';
  bytes.insert(bytes.size(), "behind");
  writeFile(log(), bytes);
  const EventLog scanned(log(), kAlways);
  ASSERT_TRUE(known());
  const EventLog indexed(log(), kAlways);
  ASSERT_EQ(indexed.size(), scanned.size());
  for (std::size_t i = 0; i < indexed.size(); ++i) {
    EXPECT_EQ(indexed[i].number, scanned[i].number);
    EXPECT_EQ(indexed.logUtime(i), indexed[i].log_utime);
  }
  ASSERT_FALSE(scanned.damage().empty());
  ASSERT_EQ(indexed.damage().places.size(), scanned.damage().places.size());
  for (std::size_t i = 0; i < indexed.damage().places.size(); ++i) {
    EXPECT_EQ(indexed.damage().places[i].offset, scanned.damage().places[i].offset);
    EXPECT_EQ(indexed.damage().places[i].bytes, scanned.damage().places[i].bytes);
    EXPECT_EQ(indexed.damage().places[i].reason, scanned.damage().places[i].reason);
  }
}

TEST_F(EventIndexTest, IsRebuiltWhenTheLogHasGrown) {
  write(log(), 10);
  EXPECT_EQ(EventLog(log(), kAlways).size(), 10u);
  const std::string bytes = readFile(log());
  writeFile(log(), bytes + bytes);
  EXPECT_FALSE(known());
  EXPECT_EQ(EventLog(log(), kAlways).size(), 20u);
  EXPECT_TRUE(known());
}

TEST_F(EventIndexTest, OfAnotherLogOfTheSameSizeAndAgeIsNotBelieved) {
  write(log(), 10);
  const EventLog first(log(), kAlways);
  const auto age = std::filesystem::last_write_time(log());
  write(log(), 10, 2 * kBegin);
  std::filesystem::last_write_time(log(), age);
  EXPECT_FALSE(known());
  EXPECT_EQ(EventLog(log(), kAlways)[0].log_utime, 2 * kBegin);
}

TEST_F(EventIndexTest, ThatIsDamagedIsNotBelieved) {
  write(log(), 10);
  const EventLog first(log(), kAlways);
  const std::string whole = readFile(index());
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    writeFile(index(), bytes);
    EXPECT_FALSE(known()) << "byte " << at << " flipped";
    writeFile(index(), whole.substr(0, at));
    EXPECT_FALSE(known()) << "cut at " << at;
  }
  EXPECT_EQ(EventLog(log(), kAlways).size(), 10u);
  EXPECT_EQ(readFile(index()), whole);
}

TEST_F(EventIndexTest, IsNotMadeForSmallLogs) {
  write(log(), 10);
  EXPECT_EQ(EventLog(log()).size(), 10u);
  EXPECT_FALSE(std::filesystem::exists(index()));
}

TEST_F(EventIndexTest, FindsTheFirstEventAtOrAfterATime) {
  write(log(), 100);
  const EventLog events(log());
  EXPECT_EQ(events.indexAt(0), 0u);
  EXPECT_EQ(events.indexAt(kBegin + 40 * kStep), 40u);
  EXPECT_EQ(events.indexAt(kBegin + 40 * kStep + 1), 41u);
  EXPECT_EQ(events.indexAt(kBegin + 99 * kStep + 1), 100u);
}

TEST_F(EventIndexTest, IsNotLedAstrayByACorruptTime) {
  write(log(), 101);
  std::string bytes = readFile(log());
  const std::size_t event_bytes = bytes.size() / 101;
  for (const std::size_t event : {25u, 50u, 75u}) {
    bytes[event * event_bytes + 12] = '\x40';
  }
  writeFile(log(), bytes);
  const EventLog events(log());
  for (const int event : {10, 40, 60, 90}) {
    EXPECT_EQ(events.indexAt(kBegin + event * kStep), static_cast<std::size_t>(event));
  }
}

TEST_F(EventIndexTest, PartsOfASplitLogAreOneLogInTheOrderOfTime) {
  // Rotated: .0 is the newest.
  write(folder_.file("flight.lcm.0"), 3, 30 * kBegin);
  write(folder_.file("flight.lcm.1"), 4, 20 * kBegin);
  write(folder_.file("flight.lcm.10"), 5, 10 * kBegin);
  writeFile(folder_.file("flight.lcm.2"), "");
  writeFile(folder_.file("flight.lcm.1.index"), "no part");
  writeFile(folder_.file("flight.lcm.old"), "no part");
  const EventLog events(log());
  ASSERT_EQ(events.size(), 12u);
  EXPECT_EQ(events.files().size(), 4u);
  core::Utime last = 0;
  for (const Event& event : events) {
    EXPECT_GT(event.log_utime, last);
    last = event.log_utime;
  }
  EXPECT_EQ(events.indexAt(20 * kBegin), 5u);
  EXPECT_TRUE(events.damage().empty());
  EXPECT_EQ(EventLog(folder_.file("flight.lcm.1")).size(), 4u);
}

TEST_F(EventIndexTest, DamageOfAPartNamesItsFile) {
  write(folder_.file("flight.lcm.00"), 3);
  write(folder_.file("flight.lcm.01"), 3, 2 * kBegin);
  writeFile(folder_.file("flight.lcm.01"), readFile(folder_.file("flight.lcm.01")) + "tail");
  const EventLog events(log());
  ASSERT_EQ(events.damage().places.size(), 1u);
  EXPECT_EQ(events.damage().places[0].file, folder_.file("flight.lcm.01"));
}

}  // namespace
}  // namespace roundabout::logs
