// What every protocol of the table must do. Sessions talk to emulators over loopback sockets; time
// is the test's.

#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "common/config/keys.h"
#include "mocap_bridge/sources/sockets.h"
#include "mocap_bridge/sources/table.h"
#include "tests/support/mocap_fixtures.h"

namespace roundabout::mocap_bridge {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr core::Utime kStep = 5'000;

/// No file can be opened while it lives.
class NoDescriptors {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &usual_);
    const rlimit none{3, usual_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &usual_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit usual_{};
};

class EveryProtocol : public testing::TestWithParam<Protocol> {
 protected:
  EveryProtocol() {
    std::tie(settings_.command_port, settings_.data_port) = freePorts();
    mocap_.server = "127.0.0.1";
    mocap_.interface = "127.0.0.1";
    mocap_.command_port = settings_.command_port;
    mocap_.data_port = settings_.data_port;
    for (int i = 0; i < 3; ++i) {
      BodyPose& body = scene_.bodies.emplace_back();
      body.name = "hex" + std::to_string(i + 1);
      body.id = i + 1;
      body.tracked = true;
      body.orientation = Eigen::AngleAxisd(0.3 + i, Eigen::Vector3d(0.1, 0.2, 0.9).normalized());
      body.position_m = {1.0 + i, -2.0, 0.5};
    }
  }

  void startServer() { emulator_ = GetParam().make_emulator(settings_); }
  void startSession() { session_ = GetParam().make_session(mocap_); }

  void step() {
    now_ += kStep;
    if (emulator_) {
      emulator_->poll(now_);
      ++scene_.number;
      scene_.exposure_utime = now_ - 4'000;
      for (BodyPose& body : scene_.bodies) {
        body.position_m.y() = 1e-3 * static_cast<double>(scene_.number);
      }
      emulator_->send(scene_, now_);
    }
    poll();
    if (emulator_) {
      emulator_->poll(now_);
      poll();
    }
  }
  void poll() {
    session_->poll(now_, heard_);
    for (std::string& note : session_->takeNotes()) {
      notes_.push_back(std::move(note));
    }
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 200.0); ++i) {
      step();
    }
  }
  const BodyPose* lastPoseOf(const std::string& name) const {
    for (const BodyPose& body : heard_.frames.back().bodies) {
      if (body.name == name) {
        return &body;
      }
    }
    return nullptr;
  }

  EmulatorSettings settings_;
  config::Mocap mocap_;
  SourceFrame scene_;
  std::unique_ptr<Emulator> emulator_;
  std::unique_ptr<Source> session_;
  core::Utime now_ = 1'700'000'000'000'000;
  test::Collected heard_;
  std::vector<std::string> notes_;
};

TEST_P(EveryProtocol, DeliversWhatItsEmulatorServes) {
  startServer();
  startSession();
  run(3.0);
  ASSERT_GT(heard_.frames.size(), 550U);
  const SourceFrame& last = heard_.frames.back();
  ASSERT_EQ(last.bodies.size(), 3U);
  for (const BodyPose& sent : scene_.bodies) {
    const BodyPose* pose = lastPoseOf(sent.name);
    ASSERT_NE(pose, nullptr) << sent.name;
    EXPECT_TRUE(pose->tracked);
    EXPECT_LT((pose->position_m - sent.position_m).norm(), 1e-5);
    EXPECT_LT(pose->orientation.angularDistance(sent.orientation), 1e-3);
  }
  EXPECT_NEAR(static_cast<double>(now_ - last.exposure_utime), 4'500.0, 600.0);
  const SourceStatus status = session_->status();
  EXPECT_TRUE(status.connected);
  EXPECT_THAT(status.bodies, testing::UnorderedElementsAre("hex1", "hex2", "hex3"));
  EXPECT_EQ(status.counters.malformed, 0);
}

TEST_P(EveryProtocol, ABodyThatIsNotSeenIsNotTracked) {
  startServer();
  startSession();
  run(1.0);
  scene_.bodies[1].tracked = false;
  run(0.5);
  ASSERT_FALSE(heard_.frames.empty());
  const BodyPose* pose = lastPoseOf("hex2");
  EXPECT_TRUE(pose == nullptr || !pose->tracked);
  ASSERT_NE(lastPoseOf("hex1"), nullptr);
  EXPECT_TRUE(lastPoseOf("hex1")->tracked);
}

TEST_P(EveryProtocol, ASilentServerIsSaidOnceWithWhatToDo) {
  startSession();
  run(1.9);
  EXPECT_TRUE(notes_.empty());
  run(5.0);
  ASSERT_EQ(notes_.size(), 1U) << testing::PrintToString(notes_);
  EXPECT_THAT(notes_[0], HasSubstr("for 2 s"));
  EXPECT_THAT(notes_[0], HasSubstr("mocap."));
  startServer();
  run(3.0);
  EXPECT_GT(heard_.frames.size(), 200U);
}

TEST_P(EveryProtocol, ComesBackAfterTenSecondsWithoutItsServer) {
  startServer();
  startSession();
  run(2.0);
  emulator_.reset();
  const std::size_t before = heard_.frames.size();
  run(10.0);
  EXPECT_LE(heard_.frames.size(), before + 1);
  EXPECT_FALSE(session_->status().connected);
  startServer();
  scene_.number = 0;
  run(4.0);
  EXPECT_GT(heard_.frames.size(), before + 200);
  for (const SourceFrame& frame : heard_.frames) {
    EXPECT_LE(frame.exposure_utime, frame.received_utime + 2'000);
    EXPECT_GE(frame.exposure_utime, frame.received_utime - 100'000);
  }
  for (std::size_t i = before + 1; i < heard_.frames.size(); ++i) {
    EXPECT_GT(heard_.frames[i].exposure_utime, heard_.frames[i - 1].exposure_utime);
  }
}

TEST_P(EveryProtocol, WithoutASocketItTriesAgain) {
  startServer();
  startSession();
  run(1.0);
  emulator_.reset();
  {
    const NoDescriptors no_descriptors;
    EXPECT_NO_THROW(run(8.0));
  }
  const std::size_t before = heard_.frames.size();
  startServer();
  run(3.0);
  EXPECT_GT(heard_.frames.size(), before + 200);
}

TEST_P(EveryProtocol, WhatWasRecordedIsUnderstoodAgain) {
  startServer();
  startSession();
  std::vector<std::pair<core::Utime, test::FileBytes>> recording;
  session_->setTap([&](const Packet& packet) {
    recording.emplace_back(packet.received,
                           test::FileBytes(packet.payload.begin(), packet.payload.end()));
  });
  run(2.0);
  const auto interpreter = GetParam().make_interpreter(mocap_);
  test::Collected again;
  for (const auto& [received, bytes] : recording) {
    interpreter->onPacket({received, 0, 0, bytes}, again);
  }
  ASSERT_GT(again.frames.size(), 300U);
  EXPECT_EQ(again.frames.back().bodies.size(), 3U);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryProtocol,
                         testing::ValuesIn(protocols().begin(), protocols().end()),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(ProtocolTable, IsWhatTheExperimentFileKnows) {
  std::vector<std::string> names;
  for (const Protocol& protocol : protocols()) {
    names.emplace_back(protocol.name);
  }
  EXPECT_EQ(names, config::kMocapProtocols);
  names.insert(names.begin(), "sim");
  names.emplace_back("replay");
  EXPECT_EQ(names, config::kSources);
}

}  // namespace
}  // namespace roundabout::mocap_bridge
