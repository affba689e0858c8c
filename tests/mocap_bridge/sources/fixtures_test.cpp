// Captured and synthetic packets of the other protocols, against what their notes say is in them.

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mocap_bridge/sources/qualisys/interpreter.h"
#include "mocap_bridge/sources/vicon_udp/interpreter.h"
#include "mocap_bridge/sources/vrpn/interpreter.h"
#include "tests/support/mocap_fixtures.h"

namespace roundabout::mocap_bridge {
namespace {

using test::FileBytes;
using test::mocapFixture;

#define SKIP_WITHOUT(bytes)                                            \
  if ((bytes).empty()) {                                               \
    GTEST_SKIP() << "the captured packets are not beside the project"; \
  }

constexpr core::Utime kNow = 1'700'000'000'000'000;

std::vector<vrpn::Message> messagesOf(Bytes stream) {
  Bytes rest = stream.subspan(vrpn::kCookieBytes);
  bool broken = false;
  std::vector<vrpn::Message> messages;
  while (const auto message = vrpn::takeMessage(rest, broken)) {
    messages.push_back(*message);
  }
  return messages;
}

TEST(QualisysFixtures, EveryDataPacketDecodesToTheLastByte) {
  for (const char* name :
       {"data_6d", "data_6deuler", "data_6dres", "data_6deulerres", "data_6d_and_6deulerres"}) {
    const FileBytes file = mocapFixture(std::string("qualisys_synthetic/") + name + ".bin");
    SKIP_WITHOUT(file);
    Bytes stream(file);
    bool broken = false;
    const auto packet = qualisys::takePacket(stream, broken);
    ASSERT_TRUE(packet) << name;
    EXPECT_TRUE(stream.empty());
    qualisys::Data data;
    ASSERT_STREQ(qualisys::parseData(packet->payload, data), nullptr) << name;
    ASSERT_EQ(data.bodies.size(), 2U);
    const qualisys::Body& body = data.bodies[0];
    EXPECT_TRUE(body.tracked);
    EXPECT_FLOAT_EQ(static_cast<float>(body.position_mm[0]), 1000.5F);
    EXPECT_FLOAT_EQ(static_cast<float>(body.position_mm[1]), -250.25F);
    // A yaw of 30 degrees, column by column.
    EXPECT_NEAR(body.rotation[0], std::cos(std::numbers::pi / 6), 1e-6);
    EXPECT_NEAR(body.rotation[1], std::sin(std::numbers::pi / 6), 1e-6);
    EXPECT_NEAR(body.rotation[3], -std::sin(std::numbers::pi / 6), 1e-6);
    EXPECT_FALSE(data.bodies[1].tracked);
    const bool residual =
        std::string(name) == "data_6dres" || std::string(name) == "data_6deulerres";
    EXPECT_EQ(!std::isnan(body.residual_mm), residual) << name;
    for (std::size_t size = 0; size < packet->payload.size(); ++size) {
      EXPECT_STRNE(qualisys::parseData(packet->payload.first(size), data), nullptr) << size;
    }
  }
}

TEST(QualisysFixtures, NamesStandInTheOrderOfTheSettings) {
  const FileBytes xml = mocapFixture("qualisys_xml/6d_Get6DSettingsTest.xml");
  SKIP_WITHOUT(xml);
  EXPECT_THAT(qualisys::parseBodyNames(xml),
              testing::Optional(
                  testing::ElementsAre("refined", "Table", "Screen2", "Cup", "Phone", "Screen1")));
  for (const char* other :
       {"General_GetGeneralSettingsTest.xml", "Skeleton_SkeletonSettingsGet.xml"}) {
    EXPECT_FALSE(qualisys::parseBodyNames(mocapFixture(std::string("qualisys_xml/") + other)));
  }
}

TEST(QualisysFixtures, AWholeSessionAndNamesThatDoNotFitAreNotUsed) {
  const FileBytes session = mocapFixture("qualisys_synthetic/session_server_to_client.bin");
  SKIP_WITHOUT(session);
  qualisys::QualisysInterpreter interpreter({});
  test::Collected heard;
  // In pieces, as TCP delivers.
  for (std::size_t at = 0; at < session.size(); at += 100) {
    interpreter.onPacket(
        {kNow + static_cast<core::Utime>(at) * 50, 0, 0,
         Bytes(session).subspan(at, std::min<std::size_t>(100, session.size() - at))},
        heard);
  }
  EXPECT_EQ(interpreter.counters().malformed, 0);
  EXPECT_EQ(interpreter.bodies().size(), 6U);
  ASSERT_EQ(heard.frames.size(), 5U);
  EXPECT_EQ(heard.frames[0].bodies.size(), 2U);
  EXPECT_EQ(heard.frames[0].bodies[0].name, "") << "six names for two bodies";
  EXPECT_FALSE(interpreter.namesFit());
  EXPECT_NEAR(heard.frames[0].bodies[0].position_m.x(), 1.0005, 1e-6);
  EXPECT_EQ(heard.packets.back().kind, "no_more_data");
}

TEST(VrpnFixtures, TheReferenceServersWholeStream) {
  const FileBytes stream = mocapFixture("vrpn_reference_server/tcp_server_to_client.bin");
  SKIP_WITHOUT(stream);
  vrpn::VrpnInterpreter interpreter({});
  interpreter.showEverything();
  test::Collected heard;
  for (std::size_t at = 0; at < stream.size(); at += 1000) {
    interpreter.onPacket(
        {kNow, 0, 0, Bytes(stream).subspan(at, std::min<std::size_t>(1000, stream.size() - at))},
        heard);
  }
  EXPECT_FALSE(interpreter.broken());
  EXPECT_EQ(interpreter.counters().malformed, 0);
  EXPECT_THAT(interpreter.bodies(), testing::UnorderedElementsAre("veh1", "veh2"));
  ASSERT_EQ(heard.frames.size(), 762U);
  int velocities = 0;
  for (const auto& packet : heard.packets) {
    velocities += packet.kind == "message" ? 1 : 0;
  }
  EXPECT_EQ(velocities, 381);
  std::map<std::string, std::vector<BodyPose>> poses;
  for (const SourceFrame& frame : heard.frames) {
    poses[frame.bodies.at(0).name].push_back(frame.bodies[0]);
  }
  const BodyPose& first = poses["veh1"].front();
  EXPECT_NEAR(first.position_m.x(), 3.80, 1e-9);
  EXPECT_NEAR(first.position_m.y(), -2.25, 1e-9);
  EXPECT_NEAR(first.orientation.z(), 0.1147467, 1e-7);
  EXPECT_NEAR(first.orientation.w(), 0.9933948, 1e-7);
  for (std::size_t i = 1; i < poses["veh1"].size(); ++i) {
    EXPECT_NEAR(poses["veh1"][i].position_m.x() - poses["veh1"][i - 1].position_m.x(), 0.01, 1e-9);
    EXPECT_NEAR(poses["veh1"][i].orientation.angularDistance(poses["veh1"][i - 1].orientation),
                0.001, 1e-7);
  }
}

TEST(VrpnFixtures, BothPosesOfAMomentAreOneFrame) {
  const FileBytes stream = mocapFixture("vrpn_reference_server/tcp_server_to_client.bin");
  SKIP_WITHOUT(stream);
  // As recorded, and as if the second tracker had stamped its poses 0.1 ms later.
  for (const std::int32_t later_us : {0, 100}) {
    const std::vector<vrpn::Message> messages = messagesOf(stream);
    vrpn::VrpnInterpreter interpreter({});
    test::Collected heard;
    interpreter.onPacket({kNow, 0, 0, Bytes(stream).first(vrpn::kCookieBytes)}, heard);
    std::vector<std::int64_t> stamps_us;
    std::int64_t late_us = 0;
    for (vrpn::Message message : messages) {
      const bool pose = message.payload.size() == 64;
      message.microseconds += message.sender == 2 && pose ? later_us : 0;
      const std::int64_t stamp_us =
          std::int64_t{message.seconds} * 1'000'000 + message.microseconds;
      if (pose && message.sender == 1) {
        stamps_us.push_back(stamp_us);
      }
      const std::size_t before = heard.frames.size();
      interpreter.onPacket({stamp_us + 1000, 0, 0, vrpn::writeMessage(message)}, heard);
      late_us = heard.frames.size() > before && before > 0
                    ? std::max(late_us, stamp_us - stamps_us.back())
                    : late_us;
    }
    ASSERT_EQ(stamps_us.size(), 381U);
    ASSERT_EQ(heard.frames.size(), stamps_us.size());
    EXPECT_EQ(late_us, later_us) << "a frame goes out with its last body";
    for (std::size_t i = 0; i < heard.frames.size(); ++i) {
      const SourceFrame& frame = heard.frames[i];
      ASSERT_EQ(frame.bodies.size(), 2U) << i;
      EXPECT_EQ(frame.bodies[0].name, "veh1");
      EXPECT_EQ(frame.bodies[1].name, "veh2:1");
      EXPECT_NEAR(frame.bodies[0].position_m.x() + frame.bodies[1].position_m.x(), 0.0, 1e-9);
      EXPECT_NEAR(static_cast<double>(frame.exposure_utime - heard.frames[0].exposure_utime),
                  static_cast<double>(stamps_us[i] - stamps_us[0]), 2.0);
    }
    EXPECT_EQ(interpreter.counters().old_frames, 0);
  }
}

/// A server of VRPN with one tracker a body, as an interpreter hears it.
class VrpnServer {
 public:
  VrpnServer() {
    say(vrpn::writeCookie());
    say(vrpn::writeDescription(vrpn::kTypeDescription, 4, vrpn::kPoseType));
    for (std::int32_t id = 0; id < 30; ++id) {
      say(vrpn::writeDescription(vrpn::kSenderDescription, id, "b" + std::to_string(id)));
    }
  }
  void pose(std::int32_t body, std::int32_t at_us) {
    arrival_ = kNow + at_us;
    say(vrpn::writePose({1'700'000'000, at_us, body, 4, {}}, {0, {1.0 * body, 0.0, 1.0}, {}}));
  }
  /// "0 1 2|0 1 2|": bodies of each frame.
  std::string frames() const {
    std::string text;
    for (const SourceFrame& frame : heard_.frames) {
      for (const BodyPose& body : frame.bodies) {
        text += (body.name == frame.bodies[0].name ? "" : " ") + body.name.substr(1);
      }
      text += "|";
    }
    return text;
  }
  const SourceCounters& counters() const { return interpreter_.counters(); }

 private:
  void say(const std::vector<std::byte>& bytes) {
    interpreter_.onPacket({arrival_, 0, 0, bytes}, heard_);
  }

  core::Utime arrival_ = kNow;
  vrpn::VrpnInterpreter interpreter_{config::Mocap{}};
  test::Collected heard_;
};

TEST(Vrpn, ABodySeenAgainEndsTheFrameHoweverSoon) {
  VrpnServer server;
  for (std::int32_t at_us = 0; at_us < 4000; at_us += 800) {
    server.pose(2, at_us);
    server.pose(1, at_us + 100);
  }
  EXPECT_EQ(server.frames(), "2 1|2 1|2 1|2 1|2 1|") << "at 1.25 kHz, in their order";
  server.pose(2, 4000);
  server.pose(2, 4000);
  server.pose(2, 3900);
  EXPECT_EQ(server.counters().old_frames, 2) << "the very same again, and an older one";
}

TEST(Vrpn, ManyBodiesStampedOneAfterTheOtherAreOneFrame) {
  VrpnServer server;
  for (std::int32_t frame = 0; frame < 3; ++frame) {
    for (std::int32_t body = 0; body < 30; ++body) {
      server.pose(body, 5000 * frame + 100 * body);
    }
  }
  std::string all = "0";
  for (int body = 1; body < 30; ++body) {
    all += " " + std::to_string(body);
  }
  EXPECT_EQ(server.frames(), all + "|" + all + "|" + all + "|");
}

TEST(Vrpn, ABodyThatFallsSilentDelaysOneFrameAndOneThatComesBackNone) {
  VrpnServer server;
  for (std::int32_t frame = 0; frame < 3; ++frame) {
    server.pose(0, 5000 * frame);
    server.pose(1, 5000 * frame + 100);
  }
  server.pose(0, 15'000);
  EXPECT_EQ(server.frames(), "0 1|0 1|0 1|") << "waits for the other";
  server.pose(0, 20'000);
  EXPECT_EQ(server.frames(), "0 1|0 1|0 1|0|0|");
  server.pose(0, 25'000);
  server.pose(1, 25'100);
  server.pose(0, 30'000);
  server.pose(1, 30'100);
  EXPECT_EQ(server.frames(), "0 1|0 1|0 1|0|0|0|0 1|")
      << "it was not waited for in the last but one";
}

TEST(ViconFixtures, ThreeObjects) {
  const FileBytes datagram = mocapFixture("vicon_udp_session-recorder/packet_3objects.bin");
  SKIP_WITHOUT(datagram);
  vicon::Block block;
  ASSERT_STREQ(vicon::parseBlock(datagram, block), nullptr);
  EXPECT_EQ(block.frame, 46902U);
  ASSERT_EQ(block.objects.size(), 3U);
  EXPECT_EQ(block.objects[0].name, "iwhub");
  EXPECT_NEAR(block.objects[0].translation_mm[0], -0.410869, 1e-6);
  EXPECT_NEAR(block.objects[0].rotation_rad[1], 3.012617, 1e-6);
  EXPECT_EQ(block.objects[2].name, "dolly");
  for (std::size_t size = 0; size < datagram.size(); ++size) {
    EXPECT_STRNE(vicon::parseBlock(Bytes(datagram).first(size), block), nullptr) << size;
  }
  FileBytes padded = datagram;
  padded.resize(1024);
  EXPECT_STREQ(vicon::parseBlock(padded, block), nullptr);
  padded.back() = std::byte{1};
  EXPECT_STRNE(vicon::parseBlock(padded, block), nullptr);
}

vicon::Block viconBlock(std::uint32_t frame, const std::vector<std::string>& names) {
  vicon::Block block{frame, {}};
  for (const std::string& name : names) {
    block.objects.push_back({name, {1000.0, 2000.0, 3000.0}, {0.1, 0.2, 0.3}});
  }
  return block;
}

TEST(ViconInterpreter, ADoubledBlockAddsNoBodiesAndDelaysNoFrame) {
  vicon::ViconInterpreter interpreter({});
  test::Collected heard;
  for (std::uint32_t frame = 1; frame <= 10; ++frame) {
    const auto datagram = vicon::writeBlock(viconBlock(frame, {"hex1", "hex2"}));
    interpreter.onPacket({kNow + 5000 * frame, 0, 0, datagram}, heard);
    if (frame == 5) {
      interpreter.onPacket({kNow + 5000 * frame, 0, 0, datagram}, heard);
    }
    EXPECT_EQ(heard.frames.size(), frame - (frame == 1 ? 1 : 0)) << "the first waits for its size";
    for (const SourceFrame& got : heard.frames) {
      ASSERT_EQ(got.bodies.size(), 2U);
    }
  }
  EXPECT_EQ(interpreter.counters().old_frames, 2);
}

TEST(ViconInterpreter, ANumberThatStandsStillGathersNothing) {
  vicon::ViconInterpreter interpreter({});
  test::Collected heard;
  for (int i = 0; i < 3000; ++i) {
    const auto datagram = vicon::writeBlock(viconBlock(7, {"a" + std::to_string(i), "b"}));
    interpreter.onPacket({kNow + 5000 * i, 0, 0, datagram}, heard);
  }
  interpreter.onPacket({kNow + 15'000'000, 0, 0, vicon::writeBlock(viconBlock(8, {"b"}))}, heard);
  ASSERT_FALSE(heard.frames.empty());
  EXPECT_LE(heard.frames.front().bodies.size(), 1024U);
  EXPECT_GT(interpreter.counters().old_frames, 3000);
}

TEST(ViconRotation, OrdersDifferAndAngleZeroIsNone) {
  using vicon::RotationOrder;
  const std::array<double, 3> angles{0.3, 0.5, -0.2};
  const Eigen::Quaterniond xyz = vicon::toQuaternion(angles, RotationOrder::kXyz);
  EXPECT_GT(xyz.angularDistance(vicon::toQuaternion(angles, RotationOrder::kZyx)), 0.05);
  EXPECT_GT(xyz.angularDistance(vicon::toQuaternion(angles, RotationOrder::kVector)), 0.01);
  EXPECT_TRUE(vicon::toQuaternion({0, 0, 0}, RotationOrder::kVector)
                  .isApprox(Eigen::Quaterniond::Identity()));
  const Eigen::Vector3d turned = xyz * Eigen::Vector3d::UnitZ();
  // Rx Ry Rz leaves z to Rx Ry: sin b, -sin a cos b, cos a cos b.
  EXPECT_NEAR(turned.x(), std::sin(0.5), 1e-12);
  EXPECT_NEAR(turned.y(), -std::sin(0.3) * std::cos(0.5), 1e-12);
}

TEST(Vrpn, EverySensorOfATrackerIsABody) {
  vrpn::VrpnInterpreter interpreter({});
  test::Collected heard;
  std::vector<std::byte> stream = vrpn::writeCookie();
  const auto add = [&](const std::vector<std::byte>& message) {
    stream.insert(stream.end(), message.begin(), message.end());
  };
  add(vrpn::writeDescription(vrpn::kTypeDescription, 4, vrpn::kPoseType));
  add(vrpn::writeDescription(vrpn::kSenderDescription, 0, "lab"));
  for (std::int32_t k = 0; k < 3; ++k) {
    for (std::int32_t sensor = 0; sensor < 3; ++sensor) {
      add(vrpn::writePose({100, 5000 * k, 0, 4, {}}, {sensor, {1.0 * sensor, 0.0, 1.0}, {}}));
    }
  }
  interpreter.onPacket({100'010'000, 0, 0, stream}, heard);
  EXPECT_EQ(interpreter.counters().old_frames, 0);
  ASSERT_EQ(heard.frames.size(), 3U);
  ASSERT_EQ(heard.frames[2].bodies.size(), 3U);
  EXPECT_EQ(heard.frames[2].bodies[0].name, "lab");
  EXPECT_EQ(heard.frames[2].bodies[2].name, "lab:2");
  EXPECT_EQ(heard.frames[2].bodies[2].position_m.x(), 2.0);
}

}  // namespace
}  // namespace roundabout::mocap_bridge
