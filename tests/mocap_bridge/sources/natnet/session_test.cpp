// A session and an emulated Motive on loopback sockets; time is the test's.

#include "mocap_bridge/sources/natnet/session.h"

#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "mocap_bridge/sources/natnet/emulator.h"
#include "mocap_bridge/sources/natnet/writer.h"
#include "tests/support/mocap_fixtures.h"
#include "tests/support/startup_error.h"

namespace roundabout::mocap_bridge::natnet {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr core::Utime kStep = 5'000;
// The server's clock is another one.
constexpr core::Utime kServerAhead = 86'400'000'000;

class NatnetSessionTest : public testing::Test {
 protected:
  NatnetSessionTest() {
    std::tie(settings_.command_port, settings_.data_port) = freePorts();
    frame_.bodies.resize(2);
    frame_.bodies[0].name = "hex1";
    frame_.bodies[0].id = 4;
    frame_.bodies[1].name = "hex2";
    frame_.bodies[1].id = 7;
    for (BodyPose& body : frame_.bodies) {
      body.tracked = true;
    }
  }

  void startServer(const std::string& version = "3.1", const std::string& transport = "multicast") {
    settings_.version = version;
    settings_.transport = transport;
    server_.reset();
    server_ = std::make_unique<NatnetEmulator>(settings_);
  }

  void startSession() {
    config::Mocap mocap;
    mocap.server = "127.0.0.1";
    mocap.interface = "127.0.0.1";
    mocap.command_port = settings_.command_port;
    if (settings_.version.starts_with("2")) {
      mocap.data_port = settings_.data_port;  // such servers do not say it
    }
    session_ = std::make_unique<NatnetSession>(mocap);
  }

  // Frames were exposed 4 ms before they are sent.
  void step(bool send = true) {
    now_ += kStep;
    if (server_) {
      server_->poll(now_ + kServerAhead);
      if (send) {
        ++frame_.number;
        frame_.exposure_utime = now_ + kServerAhead - 4000;
        frame_.bodies[0].position_m.x() = static_cast<double>(frame_.number);
        server_->send(frame_, now_ + kServerAhead);
      }
    }
    session_->poll(now_, heard_);
    if (server_) {
      server_->poll(now_ + kServerAhead);
      session_->poll(now_, heard_);
    }
    for (std::string& note : session_->takeNotes()) {
      notes_.push_back(std::move(note));
    }
  }
  void run(double seconds, bool send = true) {
    for (int i = 0; i < static_cast<int>(seconds * 200); ++i) {
      step(send);
    }
  }
  // Of the session's command socket.
  Endpoint clientAddress() const {
    std::vector<pollfd> descriptors;
    session_->addDescriptors(descriptors);
    sockaddr_in at{};
    socklen_t size = sizeof(at);
    getsockname(descriptors[0].fd, reinterpret_cast<sockaddr*>(&at), &size);
    return {kLoopback, ntohs(at.sin_port)};
  }
  const SourceCounters counters() const { return session_->status().counters; }

  EmulatorSettings settings_;
  std::unique_ptr<NatnetEmulator> server_;
  std::unique_ptr<NatnetSession> session_;
  SourceFrame frame_;
  core::Utime now_ = 1'700'000'000'000'000;
  test::Collected heard_;
  std::vector<std::string> notes_;
};

struct Wire {
  const char* version;
  const char* transport;
};

class NatnetSessionOn : public NatnetSessionTest, public testing::WithParamInterface<Wire> {};

TEST_P(NatnetSessionOn, ReceivesEveryFrameWithItsNameAndTheTimeOfItsExposure) {
  startServer(GetParam().version, GetParam().transport);
  startSession();
  run(3.0);
  ASSERT_FALSE(heard_.frames.empty());
  EXPECT_GE(heard_.frames.size(), 590U);
  EXPECT_EQ(counters().malformed, 0);
  const SourceFrame& last = heard_.frames.back();
  EXPECT_EQ(last.number, frame_.number);
  EXPECT_EQ(last.bodies.at(1).name, "hex2");
  EXPECT_EQ(last.bodies.at(0).position_m.x(), static_cast<double>(frame_.number));
  // Versions before 3.0 do not say when they look; the file's 5 ms are all that is known.
  const double latency_us = GetParam().version[0] == '2' ? 5000.0 : 4000.0;
  EXPECT_NEAR(static_cast<double>(now_ - last.exposure_utime), latency_us, 200.0);
  EXPECT_THAT(session_->status().bodies, testing::ElementsAre("hex1", "hex2"));
  EXPECT_TRUE(session_->status().connected);
}

INSTANTIATE_TEST_SUITE_P(Wires, NatnetSessionOn,
                         testing::Values(Wire{"2.5", "multicast"}, Wire{"2.7", "multicast"},
                                         Wire{"2.10", "multicast"}, Wire{"3.0", "multicast"},
                                         Wire{"3.1", "unicast"}, Wire{"4.0", "unicast"},
                                         Wire{"4.1", "multicast"}, Wire{"4.2", "unicast"}),
                         [](const auto& instance) {
                           std::string name =
                               std::string(instance.param.version) + instance.param.transport;
                           name[1] = '_';
                           return "v" + name;
                         });

TEST_F(NatnetSessionTest, SaysWhatToDoWhenNobodyAnswersAndKeepsTrying) {
  startSession();
  run(1.9);
  EXPECT_TRUE(notes_.empty());
  run(2.0);
  ASSERT_EQ(notes_.size(), 1U) << "once";
  EXPECT_THAT(notes_[0],
              testing::AllOf(HasSubstr("127.0.0.1:" + std::to_string(settings_.command_port)),
                             HasSubstr("Broadcast"), HasSubstr("mocap.interface")));
  startServer();
  run(1.0);
  EXPECT_GE(heard_.frames.size(), 50U);
  EXPECT_THAT(notes_, testing::Not(Contains(HasSubstr("no frame arrives"))))
      << "who has just answered has had no time to send any";
}

TEST_F(NatnetSessionTest, FramesThatNeverArriveAreExplained) {
  startServer();
  startSession();
  run(5.0, false);
  EXPECT_THAT(notes_, Contains(HasSubstr("no frame arrives by multicast 239.255.42.99")));
  run(0.1);
  EXPECT_THAT(notes_, Contains(HasSubstr("frames are back")));
}

TEST_F(NatnetSessionTest, ARestartedServerIsFollowedThoughItsClockAndVersionAreOthers) {
  startServer("3.0");
  startSession();
  run(2.0);
  server_.reset();
  run(10.0);
  EXPECT_THAT(notes_, Contains(HasSubstr("fallen silent")));
  const std::size_t before = heard_.frames.size();
  startServer("4.1");
  frame_.number = 0;
  frame_.bodies[1].name = "hex3";
  run(3.0);
  EXPECT_GT(heard_.frames.size(), before + 200);
  EXPECT_THAT(notes_, Contains(HasSubstr("Motive is back")));
  EXPECT_THAT(notes_, testing::Not(Contains(HasSubstr("no frame arrives"))));
  EXPECT_EQ(heard_.frames.back().bodies.at(1).name, "hex3");
  for (std::size_t i = before; i < heard_.frames.size(); ++i) {
    EXPECT_LE(heard_.frames[i].exposure_utime, heard_.frames[i].received_utime);
    EXPECT_NE(heard_.frames[i].bodies.at(0).position_m.x(), 0.0);
  }
}

TEST_F(NatnetSessionTest, NumbersOfTwoServersAreSaidOnce) {
  startServer();
  startSession();
  run(1.0);
  for (int i = 0; i < 300; ++i) {
    frame_.number += i % 10 == 0 ? 100'000 : i % 10 == 5 ? -100'000 : 0;
    step();
  }
  EXPECT_GE(counters().restarts, 20);
  EXPECT_LE(std::count(notes_.begin(), notes_.end(), "Motive's frame numbers began anew"), 2);
  EXPECT_EQ(std::count_if(notes_.begin(), notes_.end(),
                          [](const std::string& note) {
                            return note.find("do two servers send") != std::string::npos;
                          }),
            1);
}

TEST_F(NatnetSessionTest, EditModeIsSaidOfTheFrames) {
  startServer("3.1");
  startSession();
  frame_.recorded = true;
  run(1.0);
  ASSERT_FALSE(heard_.frames.empty());
  EXPECT_TRUE(heard_.frames.back().recorded);
}

TEST_F(NatnetSessionTest, PacketsOfAnotherMachineAreCountedAndNotLookedAt) {
  startServer("3.1", "unicast");
  startSession();
  run(1.0);
  UdpSocket stranger("stranger", {kLoopback + 1, 0});
  const std::size_t frames = heard_.frames.size();
  Frame false_frame;
  false_frame.number = 1'000'000;
  stranger.send(clientAddress(), writeFrame(false_frame, {3, 1}));
  step(false);
  EXPECT_EQ(counters().wrong_sender, 1);
  EXPECT_EQ(heard_.frames.size(), frames);
}

TEST_F(NatnetSessionTest, AChangedBitStreamIsAskedForThoughNoFrameSaysSo) {
  startServer("4.1");
  startSession();
  run(1.0);
  server_->changeBitstream({3, 0});
  run(1.5);
  EXPECT_GE(counters().malformed, 10);
  const std::size_t before = heard_.frames.size();
  run(1.0);
  EXPECT_EQ(heard_.frames.size(), before + 200);
  EXPECT_EQ(heard_.frames.back().bodies.at(1).name, "hex2");
  EXPECT_THAT(notes_, Contains(HasSubstr("as one of NatNet 4.1")));
}

TEST_F(NatnetSessionTest, FramesThatCannotBeUnderstoodAreSaidNotToBeUnderstood) {
  startServer("3.1", "unicast");
  startSession();
  run(1.0);
  UdpSocket server_too("a port of the server", {kLoopback, 0});
  const std::byte nonsense[12] = {};
  for (int i = 0; i < 600; ++i) {
    server_too.send(clientAddress(), writeMessage(MessageId::kFrame, nonsense));
    step(false);
  }
  EXPECT_THAT(notes_, Contains(testing::AllOf(HasSubstr("none can be understood"),
                                              HasSubstr("NatNet 3.1"))));
  EXPECT_THAT(notes_, testing::Not(Contains(HasSubstr("no frame arrives"))));
  run(0.1);
  EXPECT_THAT(notes_, Contains(HasSubstr("frames are understood again")));
}

TEST_F(NatnetSessionTest, AGroupThatWasLeftIsJoinedAgain) {
  startServer();
  startSession();
  run(1.0);
  std::vector<pollfd> descriptors;
  session_->addDescriptors(descriptors);
  ip_mreq group{{htonl(kDefaultGroup)}, {htonl(kLoopback)}};
  ASSERT_EQ(setsockopt(descriptors.at(1).fd, IPPROTO_IP, IP_DROP_MEMBERSHIP, &group, sizeof(group)),
            0);
  run(0.1);
  const std::size_t before = heard_.frames.size();
  run(1.0);
  ASSERT_EQ(heard_.frames.size(), before);
  run(2.0);
  EXPECT_GT(heard_.frames.size(), before + 100);
}

TEST_F(NatnetSessionTest, OnlyAServerInfoThatCanBeReadIsAServerAndAfterSilenceAnotherMayBe) {
  config::Mocap mocap;
  mocap.interface = "127.0.0.1";
  session_ = std::make_unique<NatnetSession>(mocap);
  step();
  UdpSocket stranger("stranger", {kLoopback + 1, 0});
  stranger.send(clientAddress(), writeMessage(MessageId::kServerInfo));
  step();
  EXPECT_THAT(notes_, testing::Not(Contains(HasSubstr("found"))));
  ServerInfo info;
  info.version = {2, 7};
  for (const std::uint32_t address : {kLoopback + 2, kLoopback + 3}) {
    UdpSocket server("server", {address, 0});
    server.send(clientAddress(), writeServerInfo(info));
    step();
    EXPECT_THAT(notes_, Contains(HasSubstr("found a NatNet server at " + addressText(address))));
    EXPECT_TRUE(session_->status().connected);
    run(2.5);
    EXPECT_FALSE(session_->status().connected);
  }
}

TEST(NatnetRate, IsAskedForUntilAnsweredAndAgainOfAnotherServer) {
  NatnetInterpreter interpreter({});
  test::Collected heard;
  const auto hear = [&](const std::vector<std::byte>& datagram) {
    interpreter.onPacket({1'700'000'000'000'000, 0, 0, datagram}, heard);
  };
  ServerInfo info;
  info.version = {2, 5};
  hear(writeServerInfo(info));
  EXPECT_TRUE(interpreter.needsRate());
  LittleEndianWriter rate;
  rate.put(100.0F);
  hear(writeMessage(MessageId::kResponse, rate.bytes()));
  EXPECT_FALSE(interpreter.needsRate());
  info.version = {2, 7};
  hear(writeServerInfo(info));
  EXPECT_TRUE(interpreter.needsRate());
  EXPECT_FALSE(NatnetInterpreter({std::nullopt, 0.005, 100.0}).needsRate()) << "the file says it";
}

TEST_F(NatnetSessionTest, DoubledAndBrokenPacketsAreCounted) {
  startServer();
  startSession();
  run(1.0);
  const SourceCounters before = counters();
  server_->send(frame_, now_ + kServerAhead);  // the same number again
  step();
  EXPECT_EQ(counters().old_frames, before.old_frames + 1);
  frame_.number += 3;
  step();
  EXPECT_EQ(counters().lost_frames, before.lost_frames + 3);
  const std::byte nonsense[12] = {};
  UdpSocket server_too("a port of the server", {kLoopback, 0});
  server_too.send(clientAddress(), writeMessage(MessageId::kFrame, nonsense));
  server_too.send(clientAddress(), Bytes(nonsense).first(3));
  step();
  EXPECT_EQ(counters().malformed, before.malformed + 2);
}

TEST_F(NatnetSessionTest, UnknownHostsInterfacesAndGroupsEndTheStart) {
  config::Mocap mocap;
  mocap.server = "no host.invalid";
  EXPECT_THAT(test::startupErrorOf([&] { NatnetSession{mocap}; }), HasSubstr("mocap.server"));
  mocap.server = "127.0.0.1";
  mocap.interface = "eth77";
  EXPECT_THAT(test::startupErrorOf([&] { NatnetSession{mocap}; }),
              testing::AllOf(HasSubstr("mocap.interface"), HasSubstr("lo 127.0.0.1")));
  mocap.interface.clear();
  mocap.group = "10.0.0.1";
  EXPECT_THAT(test::startupErrorOf([&] { NatnetSession{mocap}; }), HasSubstr("224.0.0.0"));
}

}  // namespace
}  // namespace roundabout::mocap_bridge::natnet
