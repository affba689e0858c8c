#include "perception/perception_node.h"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/polygon.h"
#include "sim/sensors/depth_camera.h"
#include "tests/perception/crowd.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::perception {
namespace {

using std::chrono::milliseconds;

constexpr std::int8_t kGood = roundabout_msgs::agent_tracks_t::GOOD;
constexpr std::int8_t kDegraded = roundabout_msgs::agent_tracks_t::DEGRADED;
constexpr std::int8_t kBlind = roundabout_msgs::agent_tracks_t::BLIND;

/// Sees a box around the whole picture; one that ends with "bad" does not decode.
class FakeDetector final : public PersonDetector {
 public:
  std::optional<std::vector<PersonBox>> detect(std::span<const std::uint8_t> jpeg) override {
    if (std::string(jpeg.begin(), jpeg.end()).ends_with("bad")) {
      return std::nullopt;
    }
    return std::vector<PersonBox>{{0.0, 0.0, 320.0, 240.0, 1.0}};
  }
  std::string name() const override { return "fake"; }
};

/// A robot at rest with a lidar among people, on a bus in memory.
class PerceptionNodeTest : public ::testing::Test {
 protected:
  PerceptionNodeTest() {
    experiment_.file = "test.yaml";
    experiment_.vehicles.resize(1);
    config::Vehicle& robot = experiment_.vehicles.front();
    robot.name = "robot";
    robot.model = "ground_robot";
    robot.lidar.emplace();
    robot.lidar->beams = 1080;
    robot.lidar->max_range_m = 10.0;
    experiment_.perception.map_rate_hz = 4.0;
    test::CrowdSettings settings;
    settings.walls = true;
    crowd_ = std::make_unique<test::Crowd>(settings);
    const auto ignore = [](const bus::DecodeError&) { FAIL() << "the node sent garbage"; };
    bus::subscribe<roundabout_msgs::agent_tracks_t>(
        lab_, "AGENT_TRACKS_robot",
        [this](const roundabout_msgs::agent_tracks_t& message) { heard_.push_back(message); },
        ignore);
    bus::subscribe<roundabout_msgs::occupancy_t>(
        lab_, "OCCUPANCY_robot",
        [this](const roundabout_msgs::occupancy_t& message) { maps_.push_back(message); }, ignore);
  }

  void start(bool with_detector = false) {
    node_ = std::make_unique<PerceptionNode>(
        experiment_, "robot", with_detector ? std::make_unique<FakeDetector>() : nullptr, own_bus_);
  }

  void sendPose(core::Utime utime, double x_m = 0.0, bool tracked = true) {
    core::StatesFrame frame;
    frame.utime = utime;
    frame.vehicles.resize(1);
    frame.vehicles[0].name = "robot";
    frame.vehicles[0].tracked = tracked;
    frame.vehicles[0].position_world_m.x() = x_m;
    bus::publish(lab_, "VEHICLE_STATES", bus::toMessage(frame));
  }

  /// Poses at 200 Hz and, unless told otherwise, scans at 40 Hz.
  void run(double duration_s, bool scans = true) {
    for (int i = 0; i < static_cast<int>(duration_s * 200.0); ++i) {
      now_ += 5'000;
      sendPose(now_);
      if (now_ % 25'000 == 0) {
        crowd_->step(0.025);
        core::LaserScan scan = crowd_->scan();
        scan.utime = now_;
        if (scans) {
          bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
        }
      }
      deliver();
    }
  }

  /// A second of which all poses are there before the first scan.
  void runWithLateScans(const std::function<void()>& send_pictures) {
    std::vector<core::LaserScan> late;
    for (int i = 0; i < 200; ++i) {
      now_ += 5'000;
      sendPose(now_);
      if (now_ % 25'000 == 0) {
        crowd_->step(0.025);
        late.push_back(crowd_->scan());
        late.back().utime = now_;
      }
      deliver();
    }
    send_pictures();
    for (const core::LaserScan& scan : late) {
      bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
      deliver();
    }
  }

  void deliver() {
    own_bus_.handle(milliseconds(0));
    lab_.handle(milliseconds(0));
  }

  void sendImage(const std::string& bytes, core::Utime utime) {
    core::JpegImage image;
    image.utime = utime;
    image.width = 320;
    image.height = 240;
    // Its frame header says 320 x 240.
    image.jpeg = {0xFF, 0xD8, 0xFF, 0xC0, 0x00, 0x11, 0x08, 0x00, 0xF0, 0x01, 0x40};
    image.jpeg.insert(image.jpeg.end(), bytes.begin(), bytes.end());
    bus::publish(lab_, "IMAGE_robot_front", bus::toMessage(image));
    deliver();
  }

  config::Experiment experiment_;
  std::shared_ptr<bus::MemoryNetwork> network_ = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus own_bus_{network_};
  bus::MemoryBus lab_{network_};
  std::unique_ptr<test::Crowd> crowd_;
  std::unique_ptr<PerceptionNode> node_;
  std::vector<roundabout_msgs::agent_tracks_t> heard_;
  std::vector<roundabout_msgs::occupancy_t> maps_;
  core::Utime now_ = 1'000'000;
};

TEST_F(PerceptionNodeTest, SaysTracksOfEverySweepAndAMapEverySecond) {
  start();
  run(3.0);
  ASSERT_GT(heard_.size(), 110U);
  EXPECT_EQ(heard_.back().vehicle, "robot");
  EXPECT_EQ(heard_.back().health, kGood);
  // The lidar of the experiment looks half way round.
  EXPECT_GE(heard_.back().num_tracks, 4);
  EXPECT_GE(maps_.size(), 2U);
  EXPECT_GT(maps_.back().num_bytes, 1000);
}

TEST_F(PerceptionNodeTest, IsBlindUntilItHasLookedForAWhile) {
  start();
  run(1.0);
  // Nobody is believed at first sight: no tracks do not mean that nobody is there.
  ASSERT_FALSE(heard_.empty());
  const auto good = std::find_if(heard_.begin(), heard_.end(),
                                 [](const auto& tracks) { return tracks.health == kGood; });
  ASSERT_NE(good, heard_.end());
  EXPECT_GE(good->num_tracks, 4);
  EXPECT_GE(good->utime - heard_.front().utime, 300'000);
  EXPECT_LT(good->utime - heard_.front().utime, 400'000);
  EXPECT_EQ(std::prev(good)->health, kBlind);
  EXPECT_EQ(std::prev(good)->reason, "it has only begun to look");
}

TEST_F(PerceptionNodeTest, SaysThatItIsBlindWithoutScans) {
  start();
  run(1.0);
  run(0.6, false);
  EXPECT_EQ(heard_.back().health, kBlind);
  EXPECT_EQ(heard_.back().num_tracks, 0);
  EXPECT_EQ(heard_.back().reason, "no usable laser scan for 0.3 s");
  // Its tracks are gone, and nobody is believed at first sight.
  const std::size_t before = heard_.size();
  run(1.0);
  EXPECT_EQ(heard_.back().health, kGood);
  const auto beginning = std::count_if(
      heard_.begin() + static_cast<std::ptrdiff_t>(before), heard_.end(),
      [](const auto& message) { return message.reason == "it has only begun to look"; });
  EXPECT_GE(beginning, 12) << "0.3 s of scans at 40 Hz";
  EXPECT_TRUE(std::is_partitioned(heard_.begin() + static_cast<std::ptrdiff_t>(before),
                                  heard_.end(),
                                  [](const auto& message) { return message.health == kBlind; }));
}

TEST_F(PerceptionNodeTest, SaysThatItIsBlindWithoutPoses) {
  start();
  run(1.0);
  for (int i = 0; i < 120; ++i) {
    now_ += 5'000;
    sendPose(now_, 0.0, false);
    deliver();
  }
  EXPECT_EQ(heard_.back().health, kBlind);
  EXPECT_EQ(heard_.back().reason, "the own vehicle's pose is not known");
  EXPECT_GE(heard_.back().rejected_poses, 100);
}

TEST_F(PerceptionNodeTest, CountsAndSurvivesWhatIsBroken) {
  start();
  run(0.5);
  const std::vector<std::byte> garbage(40, std::byte{0xAB});
  lab_.publish("LASER_SCAN_robot", garbage);
  lab_.publish("VEHICLE_STATES", garbage);
  core::LaserScan scan = crowd_->scan();
  scan.utime = now_ + 1;
  scan.ranges_m.resize(7);
  bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
  scan = crowd_->scan();
  scan.utime = now_ + 2;
  scan.first_angle_rad = std::numeric_limits<double>::quiet_NaN();
  bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
  scan = crowd_->scan();
  scan.utime = now_ + 3;
  for (std::size_t i = 0; i < 200; ++i) {
    scan.ranges_m[5 * i] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : -1.0F;
  }
  bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
  deliver();
  run(0.1);
  EXPECT_EQ(heard_.back().rejected_scans, 3);
  EXPECT_EQ(heard_.back().rejected_poses, 1);
  EXPECT_EQ(heard_.back().rejected_ranges, 200);
  EXPECT_GE(heard_.back().num_tracks, 4);
}

TEST_F(PerceptionNodeTest, ForgetsTheWorldWhenItsPoseHasJumped) {
  start();
  run(1.0);
  const std::int32_t before = heard_.back().tracks[0].id;
  for (int i = 0; i < 10; ++i) {
    now_ += 5'000;
    sendPose(now_, 2.0);
    deliver();
  }
  EXPECT_TRUE(node_->core().finder().tracker().all().empty());
  for (int i = 0; i < 200; ++i) {
    now_ += 5'000;
    sendPose(now_, 2.0);
    if (now_ % 25'000 == 0) {
      core::LaserScan scan = crowd_->scan();
      scan.utime = now_;
      bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
    }
    deliver();
  }
  ASSERT_GT(heard_.back().num_tracks, 0);
  EXPECT_GT(heard_.back().tracks[0].id, before);
  EXPECT_EQ(heard_.back().rejected_poses, 10);
}

TEST_F(PerceptionNodeTest, SaysTheSameInWhateverOrderMessagesArrive) {
  // All poses a little late: the order on a wire is nobody's promise.
  std::vector<std::vector<roundabout_msgs::agent_tracks_t>> said;
  for (const bool poses_first : {true, false}) {
    test::Crowd crowd({.walls = true});
    heard_.clear();
    bus::MemoryBus its_bus(network_);
    PerceptionNode node(experiment_, "robot", nullptr, its_bus);
    for (core::Utime now = 2'000'000; now < 4'000'000; now += 25'000) {
      crowd.step(0.025);
      core::LaserScan scan = crowd.scan();
      scan.utime = now;
      const auto send_poses = [&] {
        for (core::Utime at = now; at < now + 25'000; at += 5'000) {
          sendPose(at);
        }
      };
      if (poses_first) {
        send_poses();
      }
      bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
      if (!poses_first) {
        send_poses();
      }
      its_bus.handle(milliseconds(0));
      lab_.handle(milliseconds(0));
    }
    for (roundabout_msgs::agent_tracks_t& tracks : heard_) {
      tracks.compute_time = 0.0;
    }
    said.push_back(heard_);
  }
  std::erase_if(said[0], [](const auto& message) { return message.num_tracks == 0; });
  std::erase_if(said[1], [](const auto& message) { return message.num_tracks == 0; });
  ASSERT_GT(said[0].size(), 60U);
  ASSERT_EQ(said[0].size(), said[1].size());
  for (std::size_t i = 0; i < said[0].size(); ++i) {
    ASSERT_TRUE(bus::encode(said[0][i]) == bus::encode(said[1][i])) << i;
  }
}

TEST_F(PerceptionNodeTest, CountsPicturesThatDoNotDecodeAndMissesASilentCamera) {
  experiment_.vehicles[0].cameras.resize(1);
  start(true);
  run(0.5);
  sendImage("bad", now_);
  run(0.5);
  EXPECT_EQ(heard_.back().rejected_images, 1);
  sendImage("good", now_);
  run(0.5);
  EXPECT_EQ(heard_.back().rejected_images, 1);
  EXPECT_EQ(heard_.back().health, kGood);
  lab_.publish("IMAGE_robot_front", std::vector<std::byte>(50, std::byte{1}));
  run(1.2);
  EXPECT_EQ(heard_.back().rejected_images, 2);
  EXPECT_EQ(heard_.back().health, kDegraded);
  EXPECT_EQ(heard_.back().reason, "camera front is silent");
  EXPECT_GE(heard_.back().num_tracks, 4);
}

// What is ahead of a sweep that comes late need not be ahead of the vehicle's poses.
TEST_F(PerceptionNodeTest, LooksAtPicturesThatAreThereLongBeforeTheSweepsOfTheirTime) {
  experiment_.vehicles[0].cameras.resize(1);
  start(true);
  run(0.5);
  runWithLateScans([this] { sendImage("good", now_ - 100'000); });
  run(0.5);
  EXPECT_EQ(heard_.back().rejected_images, 0);
  EXPECT_TRUE(node_->core().boxes().contains("front"));
}

/// Its camera measures depth.
class PerceptionDepthTest : public PerceptionNodeTest {
 protected:
  PerceptionDepthTest() {
    config::Camera& camera = experiment_.vehicles[0].cameras.emplace_back();
    camera.width = 160;
    camera.height = 120;
    camera.depth = config::DepthSensing{};
    experiment_.perception.map_publish_hz = 4.0;
    box_ = {{{1.0, -0.3}, {1.4, -0.3}, {1.4, 0.3}, {1.0, 0.3}}, 0.0, 0.15};
  }

  core::DepthImage picture(core::Utime utime) const {
    const Eigen::AlignedBox2d room(Eigen::Vector2d(-7, -7), Eigen::Vector2d(7, 7));
    sim::DepthCamera camera(experiment_.vehicles[0].cameras[0]);
    const auto depths = camera.render({0.0, 0.0}, 0.0, {{&box_, 1}, {}, room});
    return {utime, 160, 120, {depths.begin(), depths.end()}};
  }
  void send(const core::DepthImage& image) { send(bus::toMessage(image)); }
  void send(const roundabout_msgs::image_t& message) {
    bus::publish(lab_, "IMAGE_robot_front", message);
    deliver();
  }
  /// Poses, scans and pictures; each picture is there before the scan of its time.
  void runWithPictures(double duration_s) {
    for (int i = 0; i < static_cast<int>(duration_s / 0.2); ++i) {
      send(picture(now_ + 100'000));
      run(0.2);
    }
  }
  std::size_t mappedBeyondSweeps() const {
    const StaticCells* cells = node_->core().cells();
    return cells == nullptr ? 0 : cells->depthCentres().size();
  }

  sim::Prism box_;
};

TEST_F(PerceptionDepthTest, WhatOnlyPicturesShowGoesIntoTheMap) {
  start(true);  // a detector that would find a person in every picture that it is given
  runWithPictures(1.6);
  ASSERT_GT(mappedBeyondSweeps(), 20U);
  for (const Eigen::Vector2d& centre_m : node_->core().cells()->depthCentres()) {
    EXPECT_LT(core::distanceTo(box_.outline, centre_m), 0.05) << centre_m.transpose();
  }
  EXPECT_TRUE(node_->core().boxes().empty());
  EXPECT_EQ(heard_.back().health, kGood);
  EXPECT_EQ(heard_.back().rejected_images, 0);
  EXPECT_GE(heard_.back().num_tracks, 4);
  // Nobody knows what was there before a jump.
  for (int i = 0; i < 10; ++i) {
    now_ += 5'000;
    sendPose(now_, 2.0);
    deliver();
  }
  EXPECT_EQ(mappedBeyondSweeps(), 0U);
}

TEST_F(PerceptionDepthTest, PicturesFromBeforePeopleAreBelievedAreNotUsed) {
  start();
  send(picture(now_ + 200'000));  // the first scan is at most 25 ms away
  run(1.0);
  EXPECT_EQ(mappedBeyondSweeps(), 0U);
  send(picture(now_ + 10'000));
  run(0.8);
  EXPECT_GT(mappedBeyondSweeps(), 20U);
}

TEST_F(PerceptionDepthTest, CountsPicturesThatAreNotItsCamerasAndMissesASilentOne) {
  start();
  runWithPictures(1.0);
  const std::int64_t before = heard_.back().rejected_images;
  send(picture(now_ - 500'000));  // older than the last
  core::DepthImage small = picture(now_);
  small.height = 60;
  small.depth_mm.resize(160 * 60);
  send(small);
  roundabout_msgs::image_t message = bus::toMessage(picture(now_));
  message.row_stride = 160;
  send(message);
  message = bus::toMessage(picture(now_));
  message.data.pop_back();
  message.size = static_cast<std::int32_t>(message.data.size());
  send(message);
  sendImage("a JPEG", now_);
  run(0.1);
  EXPECT_EQ(heard_.back().rejected_images, before + 5);
  run(1.2);
  EXPECT_EQ(heard_.back().health, kBlind);
  EXPECT_EQ(heard_.back().reason, "depth camera front is silent");
}

TEST_F(PerceptionDepthTest, AStampFromTheFutureHoldsUpNoOtherPicture) {
  start();
  send(picture(now_ + 5'000'000));  // before there is a pose to judge it by
  run(0.5);
  send(picture(now_ + 2'000'000));
  send(picture(std::numeric_limits<core::Utime>::max()));
  run(0.1);
  EXPECT_EQ(heard_.back().rejected_images, 3);
  EXPECT_EQ(heard_.back().health, kBlind);
  EXPECT_EQ(heard_.back().reason, "depth camera front is silent");
  runWithPictures(1.8);
  EXPECT_GT(mappedBeyondSweeps(), 20U);
  EXPECT_EQ(heard_.back().rejected_images, 3);
  EXPECT_EQ(heard_.back().health, kGood);
}

TEST_F(PerceptionDepthTest, AreUsedHoweverLateTheyCount) {
  experiment_.perception.image_delay_s = 4.0;
  config::Camera second = experiment_.vehicles[0].cameras[0];
  second.name = "second";
  experiment_.vehicles[0].cameras.push_back(second);
  start();
  for (int i = 0; i < 30; ++i) {
    const roundabout_msgs::image_t message = bus::toMessage(picture(now_ + 100'000));
    send(message);
    bus::publish(lab_, "IMAGE_robot_second", message);
    run(0.2);
  }
  EXPECT_GT(mappedBeyondSweeps(), 20U);
  EXPECT_EQ(heard_.back().rejected_images, 0);
  EXPECT_EQ(heard_.back().health, kGood);
}

TEST_F(PerceptionDepthTest, AreUsedThoughMoreComeThanTheFileSays) {
  experiment_.vehicles[0].cameras[0].rate_hz = 1.0;
  experiment_.perception.image_period_s = 0.1;
  experiment_.perception.image_delay_s = 4.0;
  start();
  for (int i = 0; i < 60; ++i) {
    send(picture(now_ + 50'000));
    run(0.1);
  }
  EXPECT_GT(mappedBeyondSweeps(), 20U);
  EXPECT_EQ(heard_.back().health, kGood);
}

TEST_F(PerceptionDepthTest, AreUsedThoughTheyAreThereLongBeforeTheSweepsOfTheirTime) {
  start();
  run(0.5);
  runWithLateScans([this] { send(picture(now_ - 100'000)); });
  run(1.0);
  EXPECT_EQ(heard_.back().rejected_images, 0);
  EXPECT_GT(mappedBeyondSweeps(), 20U);
}

// A planner that has a map without what only depths show must not drive by it.
TEST_F(PerceptionDepthTest, AreInTheMapThatGoesOutBeforeAnybodyDrives) {
  start();
  for (int i = 0; i < 20 && (heard_.empty() || heard_.back().health != kGood); ++i) {
    send(picture(now_ + 100'000));
    run(0.1);
  }
  ASSERT_EQ(heard_.back().health, kGood);
  EXPECT_FALSE(maps_.empty());
  EXPECT_GT(mappedBeyondSweeps(), 20U);
  // After a jump there is nothing in the map again.
  for (int i = 0; i < 10; ++i) {
    now_ += 5'000;
    sendPose(now_, 2.0);
    deliver();
  }
  const std::size_t before = heard_.size();
  for (int i = 0; i < 16; ++i) {
    now_ += 25'000;
    core::LaserScan scan = crowd_->scan();
    scan.utime = now_;
    bus::publish(lab_, "LASER_SCAN_robot", bus::toMessage(scan));
    sendPose(now_, 2.0);
    sendPose(now_ + 5'000, 2.0);
    deliver();
  }
  ASSERT_GT(heard_.size(), before + 10);
  EXPECT_EQ(heard_.back().health, kBlind);
  EXPECT_EQ(heard_.back().reason, "depth camera front has no picture in the map yet");
}

TEST_F(PerceptionDepthTest, ThatShowNothingAreMissedAsIfThereWereNone) {
  start();
  runWithPictures(2.0);
  ASSERT_EQ(heard_.back().health, kGood);
  for (int i = 0; i < 20; ++i) {
    core::DepthImage covered = picture(now_ + 100'000);
    // By a hand: too near to be measured, or to be believed of what says that it was.
    const std::uint16_t depth_mm = i % 2 == 0 ? 0 : 40;
    std::fill(covered.depth_mm.begin(), covered.depth_mm.end(), depth_mm);
    send(covered);
    run(0.2);
  }
  EXPECT_EQ(heard_.back().health, kBlind);
  EXPECT_EQ(heard_.back().reason, "depth camera front has shown nothing for too long");
  runWithPictures(2.0);
  EXPECT_EQ(heard_.back().health, kGood);
}

TEST_F(PerceptionDepthTest, AreMissedOfASlowCameraBeforeFivePeriods) {
  experiment_.vehicles[0].cameras[0].rate_hz = 1.0;
  start();
  for (int i = 0; i < 5; ++i) {
    send(picture(now_ + 100'000));
    run(1.0);
  }
  ASSERT_EQ(heard_.back().health, kGood);
  run(1.0);
  EXPECT_EQ(heard_.back().health, kGood) << "one may be lost";
  run(0.8);
  EXPECT_EQ(heard_.back().health, kBlind);
  EXPECT_EQ(heard_.back().reason, "depth camera front is silent");
}

TEST_F(PerceptionDepthTest, GoIntoTheMapAfterTheTimeWentBack) {
  now_ = 100'000'000;
  start();
  runWithPictures(1.6);
  ASSERT_GT(mappedBeyondSweeps(), 20U);
  now_ -= 60'000'000;
  runWithPictures(1.6);
  EXPECT_GT(mappedBeyondSweeps(), 20U);
  EXPECT_EQ(heard_.back().health, kGood);
}

TEST_F(PerceptionNodeTest, SavesItsMap) {
  const test::ScratchFolder folder;
  experiment_.perception.map_file = folder.file("world.bt");
  start();
  run(0.5);
  EXPECT_TRUE(node_->core().saveMap());
  EXPECT_GT(std::filesystem::file_size(folder / "world.bt"), 1000U);
  experiment_.perception.map_file = folder.file("nowhere/world.bt");
  bus::MemoryBus its_bus(network_);
  PerceptionNode other(experiment_, "robot", nullptr, its_bus);
  EXPECT_FALSE(other.core().saveMap());
}

TEST_F(PerceptionNodeTest, DoesNotStartWithoutALidar) {
  experiment_.vehicles[0].lidar.reset();
  EXPECT_EQ(
      test::startupErrorOf([this] { start(); }),
      "test.yaml: vehicles[0].lidar: expected one, since perception is asked for, found none");
}

}  // namespace
}  // namespace roundabout::perception
