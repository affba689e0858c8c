// The bridge on an in-memory bus, with a source that the test feeds.

#include "mocap_bridge/bridge_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "mocap_bridge/sources/replay/replay.h"
#include "tests/mocap_bridge/estimation/flown_path.h"
#include "tests/support/mocap_fixtures.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::mocap_bridge {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr core::Utime kEpoch = 1'700'000'000'000'000;

class FedSource final : public Source {
 public:
  void poll(core::Utime, PacketSink& sink) override {
    for (const SourceFrame& frame : std::exchange(frames, {})) {
      sink.onFrame(frame);
    }
  }
  void addDescriptors(std::vector<pollfd>&) const override {}
  SourceStatus status() const override { return {}; }
  core::Utime dataTime(core::Utime now) const override { return now - recorded_ago; }

  std::vector<SourceFrame> frames;
  core::Utime recorded_ago = 0;
};

class BridgeNodeTest : public testing::Test {
 protected:
  BridgeNodeTest() {
    for (const char* name : {"hex1", "hex2"}) {
      experiment_.vehicles.emplace_back().name = name;
    }
    bus::subscribe<roundabout_msgs::vehicle_states_t>(
        bus_, bus::kStatesChannel,
        [this](const roundabout_msgs::vehicle_states_t& message) { heard_.push_back(message); },
        [](const bus::DecodeError& error) { ADD_FAILURE() << error.reason; });
  }

  void start() {
    auto source = std::make_unique<FedSource>();
    source_ = source.get();
    node_ = std::make_unique<BridgeNode>(experiment_, std::move(source), "z_up", bus_);
  }

  // One frame of 200 Hz, 5 ms after its exposure.
  void step(const std::function<void(SourceFrame&)>& spoil = {}) {
    ++number_;
    SourceFrame frame;
    frame.number = number_;
    frame.exposure_utime = kEpoch + number_ * 5000;
    frame.received_utime = frame.exposure_utime + 5000;
    for (std::size_t i = 0; i < 2; ++i) {
      frame.bodies.push_back(cameras_.see(paths_[i].at(0.005 * static_cast<double>(number_)),
                                          i == 0 ? "hex1" : "hex2"));
    }
    if (spoil) {
      spoil(frame);
    }
    source_->frames = {frame};
    node_->poll(frame.received_utime);
    bus_.handle(std::chrono::milliseconds(0));
    for (std::string& note : node_->takeNotes()) {
      notes_.push_back(std::move(note));
    }
  }
  void run(double seconds, const std::function<void(SourceFrame&)>& spoil = {}) {
    for (int i = 0; i < static_cast<int>(seconds * 200.0); ++i) {
      step(spoil);
    }
  }

  config::Experiment experiment_;
  bus::MemoryBus bus_{std::make_shared<bus::MemoryNetwork>()};
  FedSource* source_ = nullptr;
  std::unique_ptr<BridgeNode> node_;
  test::FlownPath paths_[2] = {test::FlownPath(0), test::FlownPath(1)};
  test::Cameras cameras_;
  std::int64_t number_ = 0;
  std::vector<roundabout_msgs::vehicle_states_t> heard_;
  std::vector<std::string> notes_;
};

TEST_F(BridgeNodeTest, OneMessageACameraFrameWithTheTimeOfItsExposure) {
  start();
  run(0.5);
  ASSERT_EQ(heard_.size(), 100U);
  EXPECT_EQ(heard_.back().utime, kEpoch + number_ * 5000);
  EXPECT_EQ(heard_.back().exposure_utime, heard_.back().utime);
  EXPECT_EQ(heard_.back().frame_number, number_);
  EXPECT_EQ(heard_.back().vehicles[1].name, "hex2");
  EXPECT_TRUE(heard_.back().vehicles[1].tracked);
}

TEST_F(BridgeNodeTest, ResampledMessagesSayFromWhichFrameTheyAre) {
  experiment_.mocap.output = "resampled";
  experiment_.mocap.output_rate_hz = 100.0;
  start();
  run(1.0);
  EXPECT_NEAR(static_cast<double>(heard_.size()), 100.0, 2.0);
  const auto& last = heard_.back();
  EXPECT_EQ(last.utime % 10'000, 0);
  EXPECT_EQ(last.utime - last.exposure_utime, 5'000);
  EXPECT_EQ(last.vehicles[0].last_seen, last.exposure_utime);
  const auto truth = paths_[0].at(core::toSeconds(last.utime - kEpoch));
  EXPECT_NEAR(last.vehicles[0].position[0], truth.position_m.x(), 0.002);
  const std::size_t before = heard_.size();
  for (core::Utime later = 0; later < 1'000'000; later += 1'000) {
    node_->poll(last.utime + later);
  }
  bus_.handle(std::chrono::milliseconds(0));
  EXPECT_LE(heard_.size(), before + 10) << "without frames there is nothing to predict from";
}

TEST_F(BridgeNodeTest, BetweenResampledMessagesOfARecordingThereIsTimeToWait) {
  experiment_.mocap.output = "resampled";
  start();
  constexpr core::Utime kYear = 31'536'000 * core::kMicrosPerSecond;
  source_->recorded_ago = kYear;
  run(0.1);
  const core::Utime now = kEpoch + kYear + number_ * 5'000 + 7'000;
  node_->poll(now);
  EXPECT_GT(node_->nextDeadline(now), now);
  EXPECT_LE(node_->nextDeadline(now), now + 5'000);
}

TEST_F(BridgeNodeTest, WhatKeepsABodyFromBeingUsedIsSaidInFlight) {
  start();
  run(2.5);
  notes_.clear();
  run(1.5, [](SourceFrame& frame) { frame.bodies[0].residual_m = 0.1; });
  EXPECT_THAT(notes_,
              testing::ElementsAre(testing::AllOf(HasSubstr("hex1"), HasSubstr("bad fit"))));
  run(0.5);
  EXPECT_EQ(notes_.size(), 2U);
  notes_.clear();
  // The fault of the track is said, whatever the last frame's was.
  run(1.5, [](SourceFrame& frame) {
    frame.bodies[0].orientation =
        frame.bodies[0].orientation * Eigen::AngleAxisd(3.14159, Eigen::Vector3d::UnitZ());
    frame.bodies[0].tracked = frame.number % 4 != 3;
  });
  EXPECT_THAT(notes_, testing::ElementsAre(HasSubstr("wrong way round")));
}

TEST_F(BridgeNodeTest, WhenAllFramesStoppedNoBodyIsBlamed) {
  start();
  run(2.5);
  notes_.clear();
  number_ += 1'000;
  run(1.0);
  EXPECT_TRUE(heard_.back().vehicles[0].tracked);
  EXPECT_THAT(notes_, testing::IsEmpty());
  number_ += 1'000;
  run(1.5, [](SourceFrame& frame) { frame.bodies[0].tracked = false; });
  EXPECT_THAT(notes_, testing::ElementsAre(HasSubstr("hex1: nothing of body hex1")));
}

TEST_F(BridgeNodeTest, WhatIsPlayedBackIsNotPublishedAndSaidOnce) {
  start();
  run(1.0, [](SourceFrame& frame) { frame.recorded = true; });
  EXPECT_TRUE(heard_.empty());
  EXPECT_THAT(notes_, testing::ElementsAre(HasSubstr("Edit mode")));
  run(0.1);
  EXPECT_FALSE(heard_.empty());
  EXPECT_THAT(notes_, Contains(HasSubstr("live again")));
}

TEST_F(BridgeNodeTest, ABodyThatIsNotStreamedIsSaidWithThoseThatAre) {
  experiment_.mocap.bodies = {{"hex2", "Hex_Two", -1, {0, 0, 0}, {0, 0, 0}}};
  start();
  run(2.1);
  EXPECT_THAT(notes_, Contains(testing::AllOf(HasSubstr("streams no body Hex_Two"),
                                              HasSubstr("it streams hex1, hex2"))));
}

TEST_F(BridgeNodeTest, UnitsAndAxesThatMakeNoSenseAreSaid) {
  // A motion in millimetres is too fast for any gate: it stands still here.
  const auto still = [](double scale, const Eigen::Quaterniond& turned, Eigen::Vector3d at) {
    return [=](SourceFrame& frame) {
      const double tremble_m = 1e-6 * static_cast<double>(frame.number % 7);
      for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
        const Eigen::Vector3d beside(2.0 * static_cast<double>(i), tremble_m, 0.0);
        frame.bodies[i].position_m = scale * (at + beside);
        frame.bodies[i].orientation = turned;
      }
    };
  };
  start();
  run(2.1, still(1000.0, Eigen::Quaterniond::Identity(), {2.0, 3.0, 1.0}));
  EXPECT_THAT(notes_, Contains(HasSubstr("millimetres")));
  notes_.clear();
  start();
  const Eigen::Quaterniond on_its_side(Eigen::AngleAxisd(-1.57, Eigen::Vector3d::UnitX()));
  run(2.1, still(1.0, on_its_side, {2.0, 1.0, -9.0}));
  EXPECT_THAT(notes_, Contains(HasSubstr("y_up or z_up")));
  EXPECT_THAT(notes_, Contains(HasSubstr("does not stand upright")));
  notes_.clear();
  start();
  run(2.1, still(0.001, Eigen::Quaterniond::Identity(), {2.0, 3.0, 1.0}));
  EXPECT_THAT(notes_, testing::ElementsAre(HasSubstr("hex1 and hex2 are 0.2 cm apart")));
  notes_.clear();
  start();
  run(2.1, [](SourceFrame& frame) {  // flying, in millimetres
    for (BodyPose& body : frame.bodies) {
      body.position_m *= 1000.0;
    }
  });
  EXPECT_THAT(notes_, Contains(testing::AllOf(HasSubstr("hex1: nothing of body hex1"),
                                              HasSubstr("mocap.scale"))));
}

TEST_F(BridgeNodeTest, ABodyThatTheSystemNeverSeesIsSaid) {
  start();
  run(2.1, [](SourceFrame& frame) { frame.bodies[1].tracked = false; });
  EXPECT_THAT(notes_, testing::ElementsAre(testing::AllOf(HasSubstr("hex2: nothing of body hex2"),
                                                          HasSubstr("see its markers"))));
}

TEST(Replay, ARecordingIsPlayedSteppedAndAtItsPace) {
  const auto capture = test::mocapFixture("natnet_v3_mje-nz/extracted/datagrams.bin");
  if (capture.empty()) {
    GTEST_SKIP() << "the captured packets are not beside the project";
  }
  config::Mocap mocap;
  mocap.file = test::referenceFolder() / "mocap/natnet_v3_mje-nz/extracted/datagrams.bin";
  mocap.speed = 0.0;
  ReplaySource stepped(mocap);
  test::Collected one;
  stepped.poll(kEpoch, one);
  EXPECT_EQ(one.frames.size(), 1U);
  while (!stepped.finished()) {
    stepped.poll(kEpoch, one);
  }
  EXPECT_EQ(one.frames.size(), 518U);

  mocap.file = test::referenceFolder() / "mocap/natnet_v3_mje-nz/raw/traffic.pcapng";
  mocap.speed = 2.0;
  ReplaySource fast(mocap);
  test::Collected all;
  core::Utime now = kEpoch;
  for (; !fast.finished(); now += 1'000) {
    fast.poll(now, all);
  }
  EXPECT_EQ(all.frames.size(), 518U);
  const double recorded_s =
      core::toSeconds(all.frames.back().received_utime - all.frames.front().received_utime);
  EXPECT_LT(core::toSeconds(now - kEpoch), 0.5 * recorded_s + 2.0);
}

TEST(Replay, PacketsThatAreWrittenReadBack) {
  const test::ScratchFolder scratch;
  const std::string path = scratch.file("packets");
  const std::string payload = "seven bytes";
  {
    PacketWriter writer(path);
    EXPECT_TRUE(writer.write({kEpoch + 7, 1510, 1511, bytesOf(payload)}));
    EXPECT_TRUE(writer.write({kEpoch + 9, 1, 2, {}}));
  }
  const PacketFile file = readPacketFile(path);
  ASSERT_EQ(file.packets.size(), 2U);
  EXPECT_NEAR(static_cast<double>(file.packets[0].received - kEpoch), 7.0, 1.0);
  EXPECT_EQ(file.packets[0].to_port, 1511);
  EXPECT_EQ(file.packets[0].payload.size(), payload.size());
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 3);
  const PacketFile cut = readPacketFile(path);
  EXPECT_EQ(cut.packets.size(), 1U);
  EXPECT_THAT(cut.damage, HasSubstr("byte 27"));
}

}  // namespace
}  // namespace roundabout::mocap_bridge
