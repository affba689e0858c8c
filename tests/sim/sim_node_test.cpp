#include "sim/sim_node.h"

#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "sim/lockstep_pacing.h"
#include "sim/run_sim.h"
#include "tests/support/startup_error.h"

namespace roundabout::sim {
namespace {

using core::CommandMode;

constexpr core::Utime kBegin = LockstepPacing::kFirstUtime;

config::Experiment twoVehicles() {
  config::Experiment experiment;
  experiment.file = "demo.yaml";
  experiment.vehicles.resize(2);
  experiment.vehicles[0].name = "hex1";
  experiment.vehicles[1].name = "hex2";
  experiment.vehicles[0].start = config::Start{{-2.0, 0.0}, 0.0};
  experiment.vehicles[1].start = config::Start{{2.0, 0.0}, 0.0};
  return experiment;
}

std::vector<std::byte> commandPayload(const std::string& vehicle, CommandMode mode,
                                      core::Utime utime, double speed_mps = 0.0) {
  core::Command command;
  command.vehicle = vehicle;
  command.mode = mode;
  command.utime = utime;
  command.state_utime = utime;
  command.velocity_world_mps.x() = speed_mps;
  command.position_world_m = {-2.0, 0.0, 1.0};
  command.valid_for_s = 0.3;
  return bus::encode(bus::toMessage(command));
}

std::vector<std::byte> fleetPayload(core::Utime utime, std::int8_t phase) {
  roundabout_msgs::fleet_status_t status{};
  status.utime = utime;
  status.phase = phase;
  return bus::encode(status);
}

// A lab with one listener to VEHICLE_STATES.
class SimNodeTest : public testing::Test {
 protected:
  SimNodeTest() { listen(); }

  void listen() {
    bus::subscribe<roundabout_msgs::vehicle_states_t>(
        lab_, bus::kStatesChannel,
        [this](const roundabout_msgs::vehicle_states_t& message) {
          frames_.push_back(message);
          payloads_.push_back(bus::encode(message));
        },
        [](const bus::DecodeError& error) { ADD_FAILURE() << error.reason; });
  }

  void frame() {
    sim_.handle(std::chrono::milliseconds(0));
    node_.advance();
    node_.publishFrame();
    lab_.handle(std::chrono::milliseconds(0));
  }

  /// Commands hex1 on every planner tick for so long.
  void fly(CommandMode mode, double seconds, double speed_mps = 0.0) {
    for (int k = 0; k < static_cast<int>(seconds * 200.0); ++k) {
      frame();
      if (frames_.back().utime % 100'000 == 0) {
        lab_.publish("COMMAND_hex1", commandPayload("hex1", mode, frames_.back().utime, speed_mps));
      }
    }
  }

  int refused(const std::string& reason) {
    sim_.handle(std::chrono::milliseconds(0));
    return node_.rejections().count("COMMAND_hex1", reason);
  }

  std::shared_ptr<bus::MemoryNetwork> network_ = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus lab_{network_};
  bus::MemoryBus sim_{network_};
  SimNode node_{twoVehicles(), sim_, kBegin};
  std::vector<roundabout_msgs::vehicle_states_t> frames_;
  std::vector<std::vector<std::byte>> payloads_;
};

TEST_F(SimNodeTest, PublishesTheFrameGridWithEveryVehicle) {
  for (int k = 0; k < 3; ++k) {
    frame();
  }
  ASSERT_EQ(frames_.size(), 3U);
  EXPECT_EQ(frames_[0].utime, kBegin);
  EXPECT_EQ(frames_[2].utime, kBegin + 10'000);
  EXPECT_EQ(frames_[2].frame_number, 2);
  EXPECT_EQ(frames_[2].vehicles[1].name, "hex2");
  EXPECT_EQ(frames_[2].vehicles[1].last_seen, frames_[2].utime);
  EXPECT_NEAR(frames_[2].vehicles[1].position[0], 2.0, 0.01);
}

TEST_F(SimNodeTest, FliesAsCommanded) {
  fly(CommandMode::kPosition, 6.0);
  EXPECT_NEAR(frames_.back().vehicles[0].position[2], 1.0, 0.02);
  fly(CommandMode::kVelocity, 3.0, 0.5);
  EXPECT_NEAR(frames_.back().vehicles[0].velocity[0], 0.5, 0.06);
  fly(CommandMode::kLand, 8.0);
  EXPECT_NEAR(frames_.back().vehicles[0].position[2], 0.0, 0.01);
  EXPECT_NEAR(frames_.back().vehicles[1].position[2], 0.0, 0.01);
  EXPECT_EQ(node_.rejections().total(), 0);
}

TEST_F(SimNodeTest, AVehicleWithoutCommandsHoldsThenLands) {
  fly(CommandMode::kPosition, 6.0);
  for (int k = 0; k < 180; ++k) {
    frame();
  }
  EXPECT_NEAR(frames_.back().vehicles[0].position[2], 1.0, 0.02);
  for (int k = 0; k < 1000; ++k) {
    frame();
  }
  EXPECT_NEAR(frames_.back().vehicles[0].position[2], 0.0, 0.01);
  EXPECT_FALSE(node_.world().bodies()[0].motors_on);
}

TEST_F(SimNodeTest, SendsByteIdenticalFramesForTheSameSeed) {
  fly(CommandMode::kPosition, 3.0);
  const auto first = payloads_;

  bus::MemoryBus again(network_);
  SimNode twin(twoVehicles(), again, kBegin);
  payloads_.clear();
  frames_.clear();
  for (std::size_t k = 0; k < first.size(); ++k) {
    again.handle(std::chrono::milliseconds(0));
    twin.advance();
    const core::Utime utime = twin.publishFrame();
    lab_.handle(std::chrono::milliseconds(0));
    if (utime % 100'000 == 0) {
      lab_.publish("COMMAND_hex1", commandPayload("hex1", CommandMode::kPosition, utime));
    }
  }
  EXPECT_EQ(payloads_, first);
}

TEST_F(SimNodeTest, RefusesWhatIsNotACommand) {
  const std::vector<std::byte> garbage(200, std::byte{0xa5});
  lab_.publish("COMMAND_hex1", garbage);
  lab_.publish("COMMAND_hex1", garbage);
  EXPECT_EQ(refused("wrong fingerprint"), 2);
  EXPECT_EQ(node_.report().refused_messages, 2);
}

TEST_F(SimNodeTest, RefusesNumbersThatAreNotFinite) {
  frame();
  lab_.publish("COMMAND_hex1", commandPayload("hex1", CommandMode::kVelocity, kBegin,
                                              std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(refused("not a finite number"), 1);
}

TEST_F(SimNodeTest, RefusesAnotherVehiclesName) {
  lab_.publish("COMMAND_hex1", commandPayload("hex2", CommandMode::kHold, kBegin));
  EXPECT_EQ(refused("names another vehicle than its channel"), 1);
}

TEST_F(SimNodeTest, RefusesOldCommands) {
  frame();
  frame();
  lab_.publish("COMMAND_hex1", commandPayload("hex1", CommandMode::kHold, kBegin + 5000));
  lab_.publish("COMMAND_hex1", commandPayload("hex1", CommandMode::kHold, kBegin));
  EXPECT_EQ(refused("older than the command before"), 1);
}

TEST_F(SimNodeTest, EndsASecondAfterTheMissionIsDone) {
  frame();
  lab_.publish("FLEET_STATUS", fleetPayload(kBegin, roundabout_msgs::fleet_status_t::DONE));
  while (!node_.finished()) {
    frame();
    ASSERT_LT(frames_.size(), 1000U);
  }
  EXPECT_EQ(frames_.back().utime, kBegin + core::kMicrosPerSecond);
}

TEST_F(SimNodeTest, AnotherFlightsEndFromALogDoesNotEndIt) {
  for (int k = 0; k < 3; ++k) {
    frame();
  }
  const auto done = roundabout_msgs::fleet_status_t::DONE;
  lab_.publish("FLEET_STATUS", fleetPayload(0, done));
  lab_.publish("FLEET_STATUS", fleetPayload(kBegin - 1, roundabout_msgs::fleet_status_t::FAILED));
  lab_.publish("FLEET_STATUS", fleetPayload(kBegin + 10'001, done));
  lab_.publish("FLEET_STATUS", fleetPayload(kBegin + 3'600'000'000, done));
  lab_.publish("FLEET_STATUS", fleetPayload(kBegin + 10'000, roundabout_msgs::fleet_status_t::GO));
  lab_.publish("FLEET_STATUS", fleetPayload(kBegin + 5'000, done));
  for (int k = 0; k < 500; ++k) {
    frame();
  }
  EXPECT_FALSE(node_.finished());
  EXPECT_EQ(node_.report().refused_messages, 5);
}

TEST_F(SimNodeTest, AFleetThatStartsIsNoCauseForComplaint) {
  frame();
  lab_.publish("FLEET_STATUS", fleetPayload(0, roundabout_msgs::fleet_status_t::WAITING));
  frame();
  EXPECT_EQ(node_.report().refused_messages, 0);
}

TEST_F(SimNodeTest, DoesNotEndWhileTheMissionGoesOn) {
  lab_.publish("FLEET_STATUS", fleetPayload(0, roundabout_msgs::fleet_status_t::WAITING));
  for (int k = 0; k < 500; ++k) {
    frame();
  }
  EXPECT_FALSE(node_.finished());
}

TEST_F(SimNodeTest, ASkippedFrameIsAGapInTheNumbersButNotInTheWorld) {
  frame();
  node_.advance();
  node_.skipFrame();
  frame();
  ASSERT_EQ(frames_.size(), 2U);
  EXPECT_EQ(frames_[1].frame_number, 2);
  EXPECT_EQ(frames_[1].utime, kBegin + 10'000);
  EXPECT_EQ(node_.report().skipped_frames, 1);
}

TEST(SimNodeLidar, PublishesSweepsAtTheirRateBeforeTheFrame) {
  config::Experiment experiment = twoVehicles();
  experiment.vehicles[0].lidar = config::Lidar{};
  experiment.vehicles[0].lidar->beams = 3;
  const auto network = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus sim(network);
  bus::MemoryBus lab(network);
  SimNode node(experiment, sim, kBegin);
  std::vector<roundabout_msgs::planar_lidar_t> scans;
  std::vector<std::string> channels;
  const auto fail = [](const bus::DecodeError& error) { ADD_FAILURE() << error.reason; };
  bus::subscribe<roundabout_msgs::planar_lidar_t>(
      lab, "LASER_SCAN_hex1",
      [&](const roundabout_msgs::planar_lidar_t& scan) {
        scans.push_back(scan);
        channels.emplace_back("scan");
      },
      fail);
  bus::subscribe<roundabout_msgs::planar_lidar_t>(
      lab, "LASER_SCAN_hex2",
      [](const roundabout_msgs::planar_lidar_t&) { ADD_FAILURE() << "hex2 has no lidar"; }, fail);
  bus::subscribe<roundabout_msgs::vehicle_states_t>(
      lab, bus::kStatesChannel,
      [&](const roundabout_msgs::vehicle_states_t&) { channels.emplace_back("states"); }, fail);
  for (int k = 0; k < 41; ++k) {
    node.advance();
    node.publishFrame();
    lab.handle(std::chrono::milliseconds(0));
  }
  // 40 Hz for 0.2 s of frames at 200 Hz; the first one at once.
  ASSERT_EQ(scans.size(), 9U);
  EXPECT_EQ(channels.front(), "scan");
  EXPECT_EQ(channels[1], "states");
  EXPECT_EQ(scans[0].utime, kBegin + node.latencyUs());
  EXPECT_EQ(scans[8].utime - scans[7].utime, 25'000);
  // hex2 stands 4 m ahead.
  EXPECT_FLOAT_EQ(scans[0].ranges[0], 6.0F);
  EXPECT_NEAR(scans[0].ranges[1], 4.0 - experiment.vehicles[1].body_radius_m, 1e-5);
  EXPECT_FLOAT_EQ(scans[0].rad0, static_cast<float>(-std::numbers::pi / 2.0));
}

TEST(LaserScannersTest, SeeObstaclesAndWallsAsTheExperimentSays) {
  config::Experiment experiment = twoVehicles();
  experiment.vehicles[0].lidar = config::Lidar{};
  experiment.vehicles[0].lidar->beams = 3;
  experiment.vehicles[0].lidar->max_range_m = 50.0;
  experiment.obstacles = {{"box", {{-2.5, 1.0}, {-1.5, 1.0}, {-1.5, 2.0}, {-2.5, 2.0}}}};
  std::vector<BodyState> bodies(2);
  bodies[0].position_world_m = {-2.0, 0.0, 1.0};
  bodies[1].position_world_m = {2.0, 0.0, 0.0};
  const auto ranges = [&] {
    LaserScanners scanners(experiment);
    return scanners.sweep(kBegin, bodies)[0].scan.ranges_m;
  };
  EXPECT_FLOAT_EQ(ranges()[0], 50.0F);
  EXPECT_FLOAT_EQ(ranges()[2], 1.0F);
  experiment.vehicles[0].lidar->sees_room_walls = true;
  EXPECT_FLOAT_EQ(ranges()[0], 10.0F);
}

TEST(SimNodeRobot, PublishesWhatItsDriversWouldAndTheTruthOfPeople) {
  config::Experiment experiment = twoVehicles();
  experiment.vehicles.resize(1);
  config::Vehicle& robot = experiment.vehicles[0];
  robot.model = "ground_robot";
  robot.localised_by = "odometry";
  robot.start = config::Start{{-5.0, 0.0}, 0.0};
  robot.cameras = {config::Camera{}};
  experiment.pedestrians.count = 3;
  const auto network = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus sim(network);
  bus::MemoryBus lab(network);
  SimNode node(experiment, sim, kBegin);
  const auto fail = [](const bus::DecodeError& error) { ADD_FAILURE() << error.reason; };
  int images = 0;
  int odometries = 0;
  int truths = 0;
  bus::subscribe<roundabout_msgs::image_t>(
      lab, bus::imageChannel(robot.name, "front"),
      [&](const roundabout_msgs::image_t& message) {
        core::JpegImage image;
        EXPECT_EQ(bus::fromMessage(message, image), nullptr);
        EXPECT_LT(image.jpeg.size(), bus::kMostImageBytes);
        ++images;
      },
      fail);
  bus::subscribe<roundabout_msgs::odometry_t>(
      lab, bus::odometryChannel(robot.name),
      [&](const roundabout_msgs::odometry_t& message) {
        EXPECT_EQ(message.vehicle, robot.name);
        ++odometries;
      },
      fail);
  bus::subscribe<roundabout_msgs::agent_tracks_t>(
      lab, bus::kPedestrianTruthChannel,
      [&](const roundabout_msgs::agent_tracks_t& message) {
        core::AgentTracks truth;
        int left_out = 0;
        EXPECT_EQ(bus::fromMessage(message, truth, left_out), nullptr);
        EXPECT_EQ(left_out, 0);
        ASSERT_EQ(truth.tracks.size(), 4U);
        EXPECT_EQ(truth.tracks[0].agent_class, core::AgentClass::kPedestrian);
        EXPECT_EQ(truth.tracks[3].id, -1);
        EXPECT_EQ(truth.tracks[3].agent_class, core::AgentClass::kVehicle);
        ++truths;
      },
      fail);
  for (int k = 0; k < 201; ++k) {  // a second and the first frame
    node.advance();
    node.publishFrame();
    lab.handle(std::chrono::milliseconds(0));
  }
  EXPECT_EQ(images, 6);
  EXPECT_EQ(odometries, 51);
  EXPECT_EQ(truths, 21);
}

TEST(RunSim, RefusesAnExperimentWithAnotherSourceOfStates) {
  config::Experiment experiment = twoVehicles();
  experiment.source = "vicon";
  app::StopSignal stop;
  app::Context context{experiment, "memq://", stop};
  EXPECT_EQ(test::startupErrorOf([&] { runSim({}, context); }),
            "demo.yaml: source: expected sim, found vicon");
}

TEST(SimNodeDuration, EndsAtItsLongestDuration) {
  config::Experiment experiment = twoVehicles();
  experiment.sim.max_duration_s = 0.1;
  bus::MemoryBus bus(std::make_shared<bus::MemoryNetwork>());
  SimNode node(experiment, bus, kBegin);
  while (!node.finished()) {
    node.advance();
    node.publishFrame();
  }
  EXPECT_EQ(node.report().frames, 21);
}

}  // namespace
}  // namespace roundabout::sim
