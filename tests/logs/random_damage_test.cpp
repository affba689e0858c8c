// Thousands of damaged logs, each held against the log before the damage: every event that no
// damaged byte belongs to has to come out as it was, and in order.

#include <algorithm>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "logs/files.h"
#include "logs/reading/event_scan.h"
#include "tests/logs/log_writer.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

constexpr int kRounds = 1500;
constexpr std::size_t kEvents = 60;

/// [begin, end) of an undamaged log.
struct Range {
  std::size_t begin;
  std::size_t end;
};

/// A damaged copy and what of the original is gone or changed.
struct Damaged {
  std::string bytes;
  std::vector<Range> hit;
};

class RandomDamage : public testing::Test {
 protected:
  RandomDamage() {
    {
      LogWriter writer(folder_.file("log"));
      for (std::size_t i = 0; i < kEvents; ++i) {
        writer.writeBytes(1'700'000'000'000'000 + 5000 * static_cast<core::Utime>(i),
                          "CHANNEL_" + std::to_string(i % 7), payload(i));
      }
    }
    whole_ = readFile(folder_.file("log"));
    for (const std::size_t offset : scanEvents(bytesOf(whole_)).offsets) {
      if (!extents_.empty()) {
        extents_.back().end = offset;
      }
      extents_.push_back({offset, whole_.size()});
    }
  }

  static std::span<const std::byte> bytesOf(const std::string& text) {
    return std::as_bytes(std::span(text));
  }

  std::size_t index(std::size_t count) { return random_.index(count); }

  /// Some carry sync words, and one a whole log of two events.
  std::vector<std::byte> payload(std::size_t event) {
    std::vector<std::byte> bytes(8 + index(1500));
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(index(256));
    }
    if (event % 9 == 4) {
      std::memcpy(bytes.data() + index(bytes.size() - 4), "\xED\xA1\xDA\x01", 4);
    }
    if (event == 30) {
      const std::string inner = innerLog();
      bytes.resize(20);
      bytes.insert(bytes.end(), bytesOf(inner).begin(), bytesOf(inner).end());
      bytes.resize(bytes.size() + 20);
    }
    return bytes;
  }

  std::string innerLog() const {
    {
      LogWriter writer(folder_.file("inner"));
      const std::vector<std::byte> nothing(10);
      writer.writeBytes(1, "INNER", nothing);
      writer.writeBytes(2, "INNER", nothing);
    }
    return readFile(folder_.file("inner"));
  }

  Damaged overwritten(std::size_t begin, const std::string& with) const {
    Damaged damaged{whole_, {}};
    const std::size_t size = std::min(with.size(), whole_.size() - begin);
    damaged.bytes.replace(begin, size, with, 0, size);
    for (std::size_t i = begin; i < begin + size; ++i) {
      if (damaged.bytes[i] != whole_[i]) {
        damaged.hit.push_back({i, i + 1});
      }
    }
    return damaged;
  }

  std::string garbage(std::size_t size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) {
      byte = static_cast<char>(index(256));
    }
    return bytes;
  }

  void expectTheRestOf(const Damaged& damaged, int round) const {
    const auto log = bytesOf(damaged.bytes);
    const EventScan scan = scanEvents(log);
    std::size_t accounted = scan.damage.skippedBytes();
    std::vector<std::string> found;
    for (const std::size_t offset : scan.offsets) {
      const Event event = eventAt(log, offset);
      const std::size_t size = kHeaderBytes + event.channel.size() + event.payload.size();
      found.push_back(damaged.bytes.substr(offset, size));
      accounted += size;
    }
    ASSERT_EQ(accounted, damaged.bytes.size()) << "round " << round;
    auto next = found.begin();
    for (std::size_t i = 0; i < extents_.size(); ++i) {
      const Range& extent = extents_[i];
      if (std::any_of(damaged.hit.begin(), damaged.hit.end(), [&](const Range& hit) {
            return hit.begin < extent.end && extent.begin < hit.end;
          })) {
        continue;
      }
      next = std::find(next, found.end(), whole_.substr(extent.begin, extent.end - extent.begin));
      ASSERT_NE(next, found.end()) << "event " << i << " is lost in round " << round;
      ++next;
    }
  }

  void expectTheRest(const std::function<Damaged()>& damage) {
    for (int round = 0; round < kRounds && !HasFatalFailure(); ++round) {
      expectTheRestOf(damage(), round);
    }
  }

  test::ScratchFolder folder_;
  core::RandomStream random_{7, "random damage"};
  std::string whole_;
  std::vector<Range> extents_;
};

TEST_F(RandomDamage, OfNothingLosesNothing) {
  ASSERT_EQ(extents_.size(), kEvents);
  EXPECT_TRUE(scanEvents(bytesOf(whole_)).damage.empty());
}

TEST_F(RandomDamage, ByTruncationAtAnyByteKeepsWhatIsBefore) {
  for (std::size_t cut = 0; cut < whole_.size() && !HasFatalFailure(); cut += 1 + cut % 7) {
    expectTheRestOf({whole_.substr(0, cut), {{cut, whole_.size()}}}, static_cast<int>(cut));
  }
}

TEST_F(RandomDamage, ByFlippedBytesCostsOnlyTheEventsHit) {
  expectTheRest([&] {
    Damaged damaged{whole_, {}};
    for (std::size_t flips = 1 + index(8); flips > 0; --flips) {
      const std::size_t at = index(whole_.size());
      damaged.bytes[at] = static_cast<char>(damaged.bytes[at] ^ static_cast<char>(1 + index(255)));
      damaged.hit.push_back({at, at + 1});
    }
    return damaged;
  });
}

TEST_F(RandomDamage, ByFlippedBytesInHeadersCostsOnlyTheEventsHit) {
  expectTheRest([&] {
    Damaged damaged{whole_, {}};
    for (std::size_t flips = 1 + index(6); flips > 0; --flips) {
      const std::size_t at = extents_[index(kEvents)].begin + index(kHeaderBytes);
      damaged.bytes[at] = static_cast<char>(damaged.bytes[at] ^ static_cast<char>(1 + index(255)));
      damaged.hit.push_back({at, at + 1});
    }
    return damaged;
  });
}

TEST_F(RandomDamage, ByZeroedBlocksCostsOnlyTheEventsHit) {
  expectTheRest(
      [&] { return overwritten(index(whole_.size()), std::string(1 + index(6000), '\0')); });
}

TEST_F(RandomDamage, ByOverwrittenBlocksCostsOnlyTheEventsHit) {
  expectTheRest([&] { return overwritten(index(whole_.size()), garbage(1 + index(6000))); });
}

TEST_F(RandomDamage, ByWrongLengthsCostsOnlyTheEventsHit) {
  expectTheRest([&] {
    const std::size_t event = index(kEvents);
    const bool payload = index(2) == 1;
    std::uint32_t length = static_cast<std::uint32_t>(random_.index(1ull << 32));
    if (index(3) == 0) {
      length %= payload ? 5000 : 64;
    } else if (payload && index(2) == 0) {
      // Ends where another event does: it swallows those between and looks sound.
      const std::size_t last = event + index(kEvents - event);
      const Event whole = eventAt(bytesOf(whole_), extents_[event].begin);
      length = static_cast<std::uint32_t>(extents_[last].end - extents_[event].begin -
                                          kHeaderBytes - whole.channel.size());
    }
    const std::uint32_t big_endian = __builtin_bswap32(length);
    return overwritten(extents_[event].begin + (payload ? 24 : 20),
                       {reinterpret_cast<const char*>(&big_endian), 4});
  });
}

TEST_F(RandomDamage, ByMissingStretchesCostsOnlyTheEventsHit) {
  expectTheRest([&] {
    const std::size_t begin = index(whole_.size());
    const std::size_t size = std::min(1 + index(6000), whole_.size() - begin);
    Damaged damaged{whole_, {{begin, begin + size}}};
    damaged.bytes.erase(begin, size);
    return damaged;
  });
}

TEST_F(RandomDamage, OfEveryKindAtOnceCostsOnlyTheEventsHit) {
  expectTheRest([&] {
    Damaged damaged = overwritten(index(whole_.size()), garbage(1 + index(300)));
    const std::size_t zeros = index(whole_.size() - 500);
    const std::size_t size = 1 + index(500);
    std::fill_n(damaged.bytes.begin() + static_cast<std::ptrdiff_t>(zeros), size, '\0');
    damaged.hit.push_back({zeros, zeros + size});
    const std::size_t cut = whole_.size() - index(3000);
    damaged.bytes.resize(cut);
    damaged.hit.push_back({cut, whole_.size()});
    return damaged;
  });
}

}  // namespace
}  // namespace roundabout::logs
