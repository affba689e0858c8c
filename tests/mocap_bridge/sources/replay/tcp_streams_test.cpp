// Captured TCP sessions, put together from segments that the test makes.

#include "mocap_bridge/sources/replay/tcp_streams.h"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/random.h"
#include "mocap_bridge/sources/replay/replay.h"
#include "mocap_bridge/sources/vrpn/parser.h"
#include "tests/support/mocap_fixtures.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/tcp_capture.h"

namespace roundabout::mocap_bridge {
namespace {

constexpr core::Utime kBegin = 1'700'000'000'000'000;
constexpr std::uint32_t kServer = 0x0a000001;
constexpr std::uint32_t kClient = 0x0a000002;

using Buffer = std::vector<std::byte>;

Buffer operator+(Buffer a, const Buffer& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// One captured connection between a server and a client.
struct Connection {
  std::uint16_t server_port = vrpn::kDefaultPort;
  std::uint16_t client_port = 40'000;
  std::uint32_t first_sequence = 1000;

  TcpSegment said(std::uint32_t place, Bytes bytes) const {
    return {kServer, kClient, server_port, client_port, first_sequence + 1 + place,
            false,   true,    bytes};
  }
  TcpSegment asked(std::uint32_t place, Bytes bytes) const {
    return {kClient, kServer, client_port, server_port, 5000 + 1 + place, false, true, bytes};
  }
  std::vector<TcpSegment> handshake() const {
    return {{kClient, kServer, client_port, server_port, 5000, true, false, {}},
            {kServer, kClient, server_port, client_port, first_sequence, true, true, {}}};
  }
};

PacketFile streamsOf(const std::vector<TcpSegment>& segments, core::Utime interval = 1000) {
  TcpStreams streams;
  PacketFile file;
  core::Utime now = kBegin;
  for (const TcpSegment& segment : segments) {
    streams.add(segment, now += interval, file);
  }
  streams.finish(file);
  return file;
}

Buffer whole(const PacketFile& file) {
  Buffer bytes;
  for (const StoredPacket& packet : file.packets) {
    bytes.insert(bytes.end(), packet.payload.begin(), packet.payload.end());
  }
  return bytes;
}

Buffer numbers(std::size_t count) {
  Buffer bytes;
  for (std::size_t i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>((i * 31) >> 3));
  }
  return bytes;
}

TEST(TcpStreams, WhatTheServerSaidWhateverTheOrderOnceAndWithoutTheClient) {
  const Buffer said = numbers(20'000);
  const Buffer asked = numbers(3'000);
  core::RandomStream random(7, "segments");
  for (int run = 0; run < 50; ++run) {
    // Its numbers overflow on the way, in half of the runs.
    const Connection connection{3883, 40'000, run % 2 == 0 ? 0xffffff00U - 5000U : 77U};
    std::vector<TcpSegment> segments;
    for (std::uint32_t place = 0; place < said.size();) {
      const auto size = std::min(static_cast<std::uint32_t>(1 + random.index(1400)),
                                 static_cast<std::uint32_t>(said.size()) - place);
      segments.push_back(connection.said(place, Bytes(said).subspan(place, size)));
      if (random.chance(0.3)) {  // again, with more or less before and behind
        const auto from = place - std::min(place, static_cast<std::uint32_t>(random.index(500)));
        const auto bytes =
            std::min(static_cast<std::size_t>(random.index(2000)), said.size() - from);
        segments.push_back(connection.said(from, Bytes(said).subspan(from, bytes)));
      }
      if (random.chance(0.3)) {
        segments.push_back(connection.asked(place / 10, Bytes(asked).subspan(place / 10, 50)));
      }
      place += size;
    }
    for (std::size_t i = 0; i + 8 < segments.size(); i += 4) {
      const auto begin = segments.begin() + static_cast<std::ptrdiff_t>(i);
      std::vector<TcpSegment> some(begin, begin + 8);
      random.shuffle(some);
      std::copy(some.begin(), some.end(), begin);
    }
    std::vector<TcpSegment> all = connection.handshake();
    all.insert(all.end(), segments.begin(), segments.end());
    const PacketFile file = streamsOf(all);
    ASSERT_EQ(whole(file), said) << run;
    ASSERT_EQ(file.gaps, 0);
    core::Utime latest = 0;
    for (const StoredPacket& packet : file.packets) {
      ASSERT_EQ(packet.connection, 1);
      ASSERT_EQ(packet.from_port, 3883);
      ASSERT_GE(packet.received, latest);
      latest = packet.received;
    }
  }
}

TEST(TcpStreams, ALostSegmentIsCountedAndTheRestGoesOn) {
  const Buffer said = numbers(6'000);
  const Connection connection;
  std::vector<TcpSegment> segments = connection.handshake();
  for (std::uint32_t place = 0; place < said.size(); place += 1000) {
    if (place != 2000 && place != 3000) {
      segments.push_back(connection.said(place, Bytes(said).subspan(place, 1000)));
    }
  }
  for (const core::Utime interval : {core::Utime{1000}, 2 * core::kMicrosPerSecond}) {
    const PacketFile file = streamsOf(segments, interval);
    EXPECT_EQ(file.gaps, 1);
    EXPECT_EQ(file.missing_bytes, 2000);
    ASSERT_EQ(file.packets.size(), 4U);
    EXPECT_FALSE(file.packets[1].after_gap);
    EXPECT_TRUE(file.packets[2].after_gap);
    EXPECT_FALSE(file.packets[3].after_gap);
    EXPECT_EQ(file.packets[2].payload.front(), said[4000]);
  }
}

TEST(TcpStreams, WithoutABeginningTheLowerPortIsTheServers) {
  const Buffer said = numbers(100);
  const Connection connection;
  const PacketFile file = streamsOf({connection.asked(0, said), connection.said(0, said)});
  ASSERT_EQ(file.packets.size(), 1U);
  EXPECT_EQ(file.packets[0].from_port, connection.server_port);
  // Whose server has the higher one says how it begins.
  const Connection odd{50'000, 40'000, 9};
  std::vector<TcpSegment> segments = odd.handshake();
  segments.push_back(odd.asked(0, said));
  segments.push_back(odd.said(0, said));
  EXPECT_EQ(streamsOf(segments).packets.at(0).from_port, 50'000);
}

/// A VRPN server's stream: greeting, descriptions, then poses of one body at 200 Hz.
class VrpnCapture : public testing::Test {
 protected:
  static Buffer greeting(std::int32_t type, const std::string& name) {
    return vrpn::writeCookie() +
           vrpn::writeDescription(vrpn::kTypeDescription, type, vrpn::kPoseType) +
           vrpn::writeDescription(vrpn::kSenderDescription, 0, name);
  }
  Buffer pose(std::int32_t type) {
    ++poses_;
    const core::Utime stamp = kBegin + 5000 * poses_;
    return vrpn::writePose({static_cast<std::int32_t>(stamp / core::kMicrosPerSecond),
                            static_cast<std::int32_t>(stamp % core::kMicrosPerSecond),
                            0,
                            type,
                            {}},
                           {0, {0.01 * poses_, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}});
  }

  void add(const TcpSegment& segment) {
    capture_.add(segment, kBegin + 5000 * poses_ + 1000, stamps_high_);
  }
  // The next packets bear a stamp that no clock shows.
  void breakTheClock() { stamps_high_ = 0xffff'ffffU; }
  void connect(const Connection& connection) {
    for (const TcpSegment& segment : connection.handshake()) {
      add(segment);
    }
    add(connection.asked(0, vrpn::writeCookie()));
  }
  /// Connected, and told of hex1, whose poses are of type 4: where the stream goes on.
  std::uint32_t greet(const Connection& connection) {
    connect(connection);
    const Buffer hello = greeting(4, "hex1");
    add(connection.said(0, hello));
    return static_cast<std::uint32_t>(hello.size());
  }

  /// What a replay of the capture shows, as fast as it goes.
  test::Collected replay(const std::string& protocol = "vrpn") {
    const test::ScratchFolder scratch;
    const std::string path = scratch.file("capture.pcapng");
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(capture_.bytes().data()),
               static_cast<std::streamsize>(capture_.bytes().size()));
    config::Mocap mocap;
    mocap.protocol = protocol;
    mocap.file = path;
    mocap.speed = 0.0;
    ReplaySource source(mocap);
    test::Collected all;
    while (!source.finished()) {
      source.poll(0, all);
    }
    counters_ = source.status().counters;
    notes_ = testing::PrintToString(source.takeNotes());
    return all;
  }

  SourceCounters counters_;
  std::string notes_;

 private:
  int poses_ = 0;
  std::optional<std::uint32_t> stamps_high_;
  test::TcpCapture capture_;
};

TEST_F(VrpnCapture, OfTwoConnectionsEachHasIdsOfItsOwn) {
  const Connection first{3883, 40'000, 1};
  const Connection second{3883, 40'002, 900'000};
  connect(first);
  const Buffer hello = greeting(4, "hex1");
  add(first.said(0, hello));
  auto place = static_cast<std::uint32_t>(hello.size());
  for (int i = 0; i < 20; ++i) {
    const Buffer bytes = pose(4);
    // Cut within a message.
    add(first.said(place, Bytes(bytes).first(30)));
    add(first.said(place + 30, Bytes(bytes).subspan(30)));
    place += static_cast<std::uint32_t>(bytes.size());
  }
  add(first.said(place, Bytes(pose(4)).first(50)));  // and it is over
  connect(second);
  const Buffer again = greeting(9, "hex2");
  add(second.said(0, again));
  place = static_cast<std::uint32_t>(again.size());
  for (int i = 0; i < 60; ++i) {
    const Buffer bytes = pose(9);
    add(second.said(place, bytes));
    add(first.said(50'000, bytes));  // somebody else's that still goes on
    place += static_cast<std::uint32_t>(bytes.size());
  }
  const test::Collected all = replay();
  EXPECT_EQ(counters_.malformed, 0);
  const auto of = [&](const std::string& name) {
    return std::count_if(all.frames.begin(), all.frames.end(),
                         [&](const SourceFrame& frame) { return frame.bodies.at(0).name == name; });
  };
  EXPECT_EQ(of("hex1"), 20) << "all but the one that was cut off";
  EXPECT_GT(of("hex2"), 15) << "after 0.2 s in which a new clock is learned";
  EXPECT_THAT(notes_, testing::HasSubstr("connections that a later one replaced"));
}

TEST_F(VrpnCapture, AGapCostsWhatWasInItAndIsSaid) {
  const Connection connection;
  std::uint32_t place = greet(connection);
  for (int i = 0; i < 60; ++i) {
    const Buffer bytes = pose(4);
    if (i < 20 || i > 22) {
      add(connection.said(place, bytes));
    }
    place += static_cast<std::uint32_t>(bytes.size());
  }
  const test::Collected all = replay();
  EXPECT_EQ(counters_.malformed, 0);
  EXPECT_GE(all.frames.size(), 20U);
  EXPECT_NEAR(all.frames.back().bodies.at(0).position_m.x(), 0.6, 0.011);
  EXPECT_THAT(notes_, testing::HasSubstr("1 gap(s) in the stream"));
}

// Every pose comes in two segments, and one first half is lost.
TEST_F(VrpnCapture, AGapThatEndsWithinAMessageCostsNoMore) {
  const Connection connection;
  std::uint32_t place = greet(connection);
  for (int i = 0; i < 60; ++i) {
    const Buffer bytes = pose(4);
    const auto half = static_cast<std::uint32_t>(bytes.size() / 2);
    if (i != 20) {
      add(connection.said(place, Buffer(bytes.begin(), bytes.begin() + half)));
    }
    add(connection.said(place + half, Buffer(bytes.begin() + half, bytes.end())));
    place += static_cast<std::uint32_t>(bytes.size());
  }
  const test::Collected all = replay();
  EXPECT_EQ(counters_.malformed, 1);
  EXPECT_NEAR(all.frames.back().bodies.at(0).position_m.x(), 0.6, 0.011);
}

TEST_F(VrpnCapture, StampsThatNoClockShowsSayNothing) {
  const Connection connection;
  std::uint32_t place = greet(connection);
  for (int i = 0; i < 100; ++i) {
    if (i == 60) {
      breakTheClock();
    }
    const Buffer bytes = pose(4);
    add(connection.said(place, bytes));
    place += static_cast<std::uint32_t>(bytes.size());
  }
  const test::Collected all = replay();
  EXPECT_EQ(counters_.malformed, 0);
  ASSERT_GE(all.frames.size(), 50U);
  EXPECT_NEAR(all.frames.back().bodies.at(0).position_m.x(), 1.0, 0.011);
  for (const SourceFrame& frame : all.frames) {
    EXPECT_LT(std::abs(frame.exposure_utime - kBegin), 2 * core::kMicrosPerSecond);
  }
}

TEST_F(VrpnCapture, OtherServersOfTheCaptureAreLeftOut) {
  const Connection other{22, 40'004, 5};
  const Connection connection;
  connect(other);
  connect(connection);
  const Buffer hello = greeting(4, "hex1");
  add(connection.said(0, hello));
  auto place = static_cast<std::uint32_t>(hello.size());
  for (std::uint32_t i = 0; i < 20; ++i) {
    const Buffer bytes = pose(4);
    add(other.said(40 * i, numbers(40)));
    add(connection.said(place, bytes));
    place += static_cast<std::uint32_t>(bytes.size());
  }
  EXPECT_EQ(replay().frames.size(), 20U);
  EXPECT_EQ(counters_.malformed, 0);
  EXPECT_THAT(notes_, testing::HasSubstr("20 packets not from TCP port 3883"));
  EXPECT_EQ(replay("natnet").frames.size(), 0U) << "is spoken in datagrams";
  EXPECT_EQ(counters_.packets, 0);
}

}  // namespace
}  // namespace roundabout::mocap_bridge
