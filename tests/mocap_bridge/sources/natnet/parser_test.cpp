#include "mocap_bridge/sources/natnet/parser.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mocap_bridge/sources/natnet/interpreter.h"
#include "mocap_bridge/sources/natnet/writer.h"
#include "tests/support/mocap_fixtures.h"

namespace roundabout::mocap_bridge::natnet {
namespace {

using test::FileBytes;
using test::mocapFixture;

#define SKIP_WITHOUT(bytes)                                            \
  if ((bytes).empty()) {                                               \
    GTEST_SKIP() << "the captured packets are not beside the project"; \
  }

Bytes payloadOf(const FileBytes& datagram) { return parseMessage(datagram)->payload; }

struct RecordedDatagram {
  double received_s;
  std::uint16_t from_port;
  std::uint16_t to_port;
  Bytes payload;
};

std::vector<RecordedDatagram> datagramsOf(const FileBytes& file) {
  std::vector<RecordedDatagram> datagrams;
  LittleEndianCursor cursor(file);
  while (cursor.remaining() > 0 && !cursor.failed()) {
    RecordedDatagram datagram;
    datagram.received_s = cursor.read<double>();
    datagram.from_port = cursor.read<std::uint16_t>();
    datagram.to_port = cursor.read<std::uint16_t>();
    datagram.payload = cursor.take(cursor.read<std::uint32_t>());
    datagrams.push_back(datagram);
  }
  return datagrams;
}

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

TEST(NatnetFrame, EveryFrameOfTheRecordedSessionEqualsTheExtractedPoses) {
  const FileBytes capture = mocapFixture("natnet_v3_mje-nz/extracted/datagrams.bin");
  SKIP_WITHOUT(capture);
  std::ifstream csv(test::referenceFolder() / "mocap/natnet_v3_mje-nz/extracted/rigid_bodies.csv");
  std::string line;
  std::getline(csv, line);
  Frame frame;
  int frames = 0;
  for (const RecordedDatagram& datagram : datagramsOf(capture)) {
    const auto message = parseMessage(datagram.payload);
    if (message->id != MessageId::kFrame) {
      continue;
    }
    ASSERT_STREQ(parseFrame(message->payload, {3, 0}, frame), nullptr) << "frame " << frames;
    ASSERT_TRUE(std::getline(csv, line));
    const auto cells = cellsOf(line);
    EXPECT_EQ(frame.number, std::stoi(cells[1]));
    ASSERT_EQ(frame.bodies.size(), 1U);
    const RigidBody& body = frame.bodies[0];
    EXPECT_EQ(body.id, std::stoi(cells[2]));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(body.position[i], std::stof(cells[3 + i]));
    }
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(body.orientation_xyzw[i], std::stof(cells[6 + i]));
    }
    EXPECT_EQ(body.mean_error_m, std::stof(cells[10]));
    EXPECT_EQ(body.tracked, (std::stoi(cells[11]) & 1) != 0);
    EXPECT_NEAR(frame.timestamp_s, std::stod(cells[12]), 1e-9);
    EXPECT_EQ(frame.mid_exposure_ticks, std::stoull(cells[13]));
    EXPECT_EQ(frame.data_received_ticks, std::stoull(cells[14]));
    EXPECT_EQ(frame.transmit_ticks, std::stoull(cells[15]));
    EXPECT_EQ(frame.params, std::stoi(cells[16]));
    ++frames;
  }
  EXPECT_EQ(frames, 518);
  EXPECT_FALSE(std::getline(csv, line)) << "poses without a frame";
}

TEST(NatnetFrame, PosesAreThoseOfTheVendorsClient) {
  const FileBytes capture = mocapFixture("natnet_v3_mje-nz/extracted/datagrams.bin");
  SKIP_WITHOUT(capture);
  std::map<int, std::array<float, 7>> ours;
  Frame frame;
  for (const RecordedDatagram& datagram : datagramsOf(capture)) {
    const auto message = parseMessage(datagram.payload);
    if (message->id == MessageId::kFrame) {
      parseFrame(message->payload, {3, 0}, frame);
      const RigidBody& body = frame.bodies.at(0);
      auto& pose = ours[frame.number];
      std::copy(body.position.begin(), body.position.end(), pose.begin());
      std::copy(body.orientation_xyzw.begin(), body.orientation_xyzw.end(), pose.begin() + 3);
    }
  }
  std::ifstream printout(test::referenceFolder() /
                         "mocap/natnet_v3_mje-nz/raw/SampleClient_output.txt");
  int number = 0;
  int compared = 0;
  bool bodies = false;
  for (std::string line; std::getline(printout, line);) {
    std::sscanf(line.c_str(), "FrameID : %d", &number);
    bodies = bodies ? line.rfind("Skeletons", 0) != 0 : line.rfind("Rigid Bodies", 0) == 0;
    std::array<float, 7> theirs{};
    if (!bodies || std::sscanf(line.c_str(), "%f %f %f %f %f %f %f", &theirs[0], &theirs[1],
                               &theirs[2], &theirs[3], &theirs[4], &theirs[5], &theirs[6]) != 7) {
      continue;
    }
    ASSERT_TRUE(ours.contains(number)) << number;
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_NEAR(ours[number][i], theirs[i], 0.00501) << "frame " << number << ", value " << i;
    }
    ++compared;
  }
  EXPECT_EQ(compared, 251);
}

TEST(NatnetFrame, OtherVersionsDecodeToTheLastByte) {
  Frame frame;
  for (const char* name : {"frame-motive-1.5.0-001.bin", "frame-motive-1.5.0-002.bin"}) {
    const FileBytes datagram = mocapFixture(std::string("natnet_v2_nordmoen/") + name);
    SKIP_WITHOUT(datagram);
    ASSERT_STREQ(parseFrame(payloadOf(datagram), {2, 5}, frame), nullptr) << name;
    ASSERT_EQ(frame.bodies.size(), 1U);
    EXPECT_EQ(frame.bodies[0].id, 1);
    EXPECT_NEAR(frame.bodies[0].position[2], 1.1235F, 1e-4F);
    EXPECT_TRUE(frame.bodies[0].tracked);
    EXPECT_EQ(frame.labeled_markers, 3);
  }
  for (const Version version : {Version{4, 0}, Version{4, 1}}) {
    const std::string digits = std::to_string(version.major) + std::to_string(version.minor);
    const FileBytes datagram = mocapFixture("natnet_v4_synthetic/frame_v" + digits + ".bin");
    ASSERT_STREQ(parseFrame(payloadOf(datagram), version, frame), nullptr) << digits;
    EXPECT_EQ(frame.number, 1234);
    ASSERT_EQ(frame.bodies.size(), 2U);
    EXPECT_EQ(frame.bodies[0].position[0], 1.25F);
    EXPECT_TRUE(frame.bodies[0].tracked);
    EXPECT_FALSE(frame.bodies[1].tracked);
    EXPECT_EQ(frame.skeletons, 1);
    EXPECT_EQ(frame.assets, version.minor);
    EXPECT_EQ(frame.labeled_markers, 2);
    EXPECT_EQ(frame.force_plates, 1);
    EXPECT_EQ(frame.devices, 1);
    EXPECT_DOUBLE_EQ(frame.timestamp_s, 12.345);
    EXPECT_EQ(frame.transmit_ticks, 1'054'000U);
  }
  const FileBytes occluded = mocapFixture("natnet_v3_mje-nz/mocapframe_packet_occluded_v3.bin");
  ASSERT_STREQ(parseFrame(payloadOf(occluded), {3, 0}, frame), nullptr);
  EXPECT_EQ(frame.bodies.at(0).id, 7);
  EXPECT_TRUE(frame.bodies.at(0).tracked) << "a hidden marker hides no body";
}

TEST(NatnetFrame, TruncatedAtEveryByteItIsRefused) {
  for (const auto& [name, version] :
       {std::pair{"natnet_v3_mje-nz/mocapframe_packet_v3.bin", Version{3, 0}},
        std::pair{"natnet_v4_synthetic/frame_v41.bin", Version{4, 1}},
        std::pair{"natnet_v2_nordmoen/frame-motive-1.5.0-001.bin", Version{2, 5}}}) {
    const FileBytes datagram = mocapFixture(name);
    SKIP_WITHOUT(datagram);
    Frame frame;
    const Bytes payload = payloadOf(datagram);
    for (std::size_t size = 0; size < payload.size(); ++size) {
      EXPECT_STRNE(parseFrame(payload.first(size), version, frame), nullptr) << name << size;
    }
    FileBytes longer = datagram;
    longer.push_back(std::byte{0});
    EXPECT_STRNE(parseFrame(payloadOf(longer), version, frame), nullptr);
  }
}

class NatnetVersions : public testing::TestWithParam<Version> {};

TEST_P(NatnetVersions, WhatIsWrittenReadsBack) {
  const Version version = GetParam();
  Frame frame;
  frame.number = 77;
  frame.bodies = {{3, {1.0F, -2.0F, 0.5F}, {0.0F, 0.6F, 0.0F, 0.8F}, 0.001F, true},
                  {9, {}, {}, 0.0F, version < Version{2, 6}}};
  frame.timestamp_s = 1.5;
  frame.software_latency_s = 1.5F;
  frame.mid_exposure_ticks = 1000;
  frame.transmit_ticks = 3000;
  frame.params = Frame::kEditMode;
  const Datagram datagram = writeFrame(frame, version);
  Frame read;
  ASSERT_STREQ(parseFrame(parseMessage(datagram)->payload, version, read), nullptr);
  ASSERT_EQ(read.bodies.size(), 2U);
  EXPECT_EQ(read.bodies[0].orientation_xyzw, frame.bodies[0].orientation_xyzw);
  EXPECT_EQ(read.bodies[1].tracked, frame.bodies[1].tracked);
  EXPECT_EQ(read.has(Frame::kEditMode), version >= Version(2, 6));

  ModelDef models{{{3, "hex1"}, {9, "naïve name"}}, 0};
  ModelDef back;
  ASSERT_STREQ(parseModelDef(parseMessage(writeModelDef(models, version))->payload, version, back),
               nullptr);
  ASSERT_EQ(back.bodies.size(), 2U);
  EXPECT_EQ(back.bodies[1].name, "naïve name");
}

INSTANTIATE_TEST_SUITE_P(All, NatnetVersions,
                         testing::Values(Version{2, 5}, Version{2, 6}, Version{2, 7}, Version{2, 9},
                                         Version{2, 10}, Version{2, 11}, Version{3, 0},
                                         Version{3, 1}, Version{4, 0}, Version{4, 1},
                                         Version{4, 2}),
                         [](const auto& instance) {
                           return "v" + std::to_string(instance.param.major) + "_" +
                                  std::to_string(instance.param.minor);
                         });

TEST(NatnetFrame, BodiesOfANewerVersionStayReadable) {
  Frame frame;
  frame.bodies = {{1, {1.0F, 2.0F, 3.0F}, {0.0F, 0.0F, 0.0F, 1.0F}, 0.0F, true},
                  {2, {4.0F, 5.0F, 6.0F}, {0.0F, 0.0F, 0.0F, 1.0F}, 0.0F, true}};
  // Bodies that are eight bytes longer, as a version of the future might have them.
  const Datagram known = writeFrame(frame, {4, 1});
  constexpr std::size_t kBodies = 4 + 4 + 2 * 8;  // header, number, two empty sections
  std::vector<std::byte> newer(known.begin(), known.begin() + kBodies + 4);
  LittleEndianWriter size;
  size.put<std::uint32_t>(2 * (38 + 8));
  newer.insert(newer.end(), size.bytes().begin(), size.bytes().end());
  for (int i = 0; i < 2; ++i) {
    const auto body = known.begin() + kBodies + 8 + 38 * i;
    newer.insert(newer.end(), body, body + 38);
    newer.insert(newer.end(), 8, std::byte{7});
  }
  newer.insert(newer.end(), known.begin() + kBodies + 8 + 76, known.end());
  Frame read;
  ASSERT_STREQ(parseFrame(payloadOf(newer), {4, 5}, read), nullptr);
  ASSERT_EQ(read.bodies.size(), 2U);
  EXPECT_EQ(read.bodies[1].position[2], 6.0F);
  EXPECT_STRNE(parseFrame(payloadOf(newer), {4, 1}, read), nullptr);
}

TEST(NatnetFrame, CountsThatLieAllocateNothing) {
  LittleEndianWriter payload;
  payload.put<std::int32_t>(1);
  payload.put<std::int32_t>(0);
  payload.put<std::int32_t>(0);
  payload.put<std::int32_t>(0x7fffffff);
  Frame frame;
  EXPECT_STRNE(parseFrame(payload.bytes(), {3, 0}, frame), nullptr);
  EXPECT_EQ(frame.bodies.capacity(), 0U);
}

TEST(NatnetModels, NamesOfRecordedAndSyntheticDefinitions) {
  const FileBytes recorded = mocapFixture("natnet_v3_mje-nz/modeldef_packet_v3.bin");
  SKIP_WITHOUT(recorded);
  ModelDef models;
  ASSERT_STREQ(parseModelDef(payloadOf(recorded), {3, 0}, models), nullptr);
  ASSERT_EQ(models.bodies.size(), 1U);
  EXPECT_EQ(models.bodies[0].name, "RaceQuad");
  EXPECT_EQ(models.bodies[0].id, 2);
  EXPECT_EQ(models.datasets, 3);
  for (const Version version : {Version{4, 0}, Version{4, 1}}) {
    const FileBytes datagram =
        mocapFixture("natnet_v4_synthetic/modeldef_v4" + std::to_string(version.minor) + ".bin");
    ASSERT_STREQ(parseModelDef(payloadOf(datagram), version, models), nullptr);
    ASSERT_EQ(models.bodies.size(), 2U);
    EXPECT_EQ(models.bodies[0].name, "veh1");
    EXPECT_EQ(models.bodies[1].id, 2);
  }
}

TEST(NatnetServerInfo, OfThreeVersions) {
  ServerInfo info;
  const FileBytes v3 = mocapFixture("natnet_v3_mje-nz/serverinfo_packet_v3.bin");
  SKIP_WITHOUT(v3);
  ASSERT_STREQ(parseServerInfo(payloadOf(v3), info), nullptr);
  EXPECT_EQ(info.name, "Motive") << "the field has junk behind its end";
  EXPECT_EQ(text(info.version), "3.0");
  EXPECT_EQ(info.tick_frequency_hz, 3'312'787U);
  EXPECT_EQ(info.data_port, 1511);
  EXPECT_TRUE(info.multicast);
  EXPECT_EQ(info.group, kDefaultGroup);
  const FileBytes v2 = mocapFixture("natnet_v2_nordmoen/frame-motive-1.5.0-000.bin");
  ASSERT_STREQ(parseServerInfo(payloadOf(v2), info), nullptr);
  EXPECT_EQ(info.name, "NatNetLib");
  EXPECT_EQ(text(info.version), "2.5");
  EXPECT_EQ(info.tick_frequency_hz, 0U);
  const FileBytes v41 = mocapFixture("natnet_v4_synthetic/serverinfo_v41.bin");
  ASSERT_STREQ(parseServerInfo(payloadOf(v41), info), nullptr);
  EXPECT_EQ(text(info.version), "4.1");
}

TEST(NatnetText, VersionsAndBitstreams) {
  EXPECT_EQ(parseVersion("2.7"), (Version{2, 7}));
  EXPECT_EQ(parseVersion("4.1.0.0"), (Version{4, 1}));
  for (const char* wrong : {"", "3", "3.", ".1", "x.y", "1.9", "3.1x", "999.1"}) {
    EXPECT_FALSE(parseVersion(wrong)) << wrong;
  }
  EXPECT_EQ(parseBitstream(bytesOf(std::string_view("Bitstream,4.1.0.0\0", 18))), (Version{4, 1}));
  EXPECT_FALSE(parseBitstream(bytesOf("Bitstream")));
}

TEST(NatnetInterpreter, UnderstandsTheWholeRecordedSession) {
  const FileBytes capture = mocapFixture("natnet_v3_mje-nz/extracted/datagrams.bin");
  SKIP_WITHOUT(capture);
  NatnetInterpreter interpreter({});
  test::Collected heard;
  std::vector<double> exposures_s;
  for (const RecordedDatagram& datagram : datagramsOf(capture)) {
    interpreter.onPacket({core::toUtime(datagram.received_s), datagram.from_port, datagram.to_port,
                          datagram.payload},
                         heard);
  }
  EXPECT_EQ(interpreter.counters().packets, 550);
  EXPECT_EQ(interpreter.counters().frames, 518);
  EXPECT_EQ(interpreter.counters().malformed, 0);
  EXPECT_EQ(interpreter.counters().lost_frames, 0);
  ASSERT_EQ(heard.frames.size(), 518U);
  EXPECT_EQ(heard.frames.back().bodies.at(0).name, "RaceQuad");
  std::map<std::string, int> kinds;
  for (const auto& packet : heard.packets) {
    ++kinds[packet.kind];
  }
  EXPECT_EQ(kinds["server_info"], 2);
  EXPECT_EQ(kinds["echo_response"], 9);
  EXPECT_EQ(kinds["model_def"], 1);
  EXPECT_EQ(kinds["unrecognized_request"], 1);
  // Arrivals jitter by up to 5 ms; exposures are 1/120 s apart.
  for (std::size_t i = 100; i < heard.frames.size(); ++i) {
    const auto& frame = heard.frames[i];
    const core::Utime interval = frame.exposure_utime - heard.frames[i - 1].exposure_utime;
    EXPECT_NEAR(static_cast<double>(interval), 8333.0, 120.0);
    EXPECT_NEAR(static_cast<double>(frame.received_utime - frame.exposure_utime), 5400.0, 6000.0);
  }
}

}  // namespace
}  // namespace roundabout::mocap_bridge::natnet
