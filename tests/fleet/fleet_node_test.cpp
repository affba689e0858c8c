#include "fleet/fleet_node.h"

#include <limits>

#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "tests/fleet/small_fleet.h"

namespace roundabout::fleet {
namespace {

using roundabout_msgs::fleet_status_t;
using std::chrono::milliseconds;

/// The fleet's node, three vehicles that never move, and planners that answer.
class FleetNodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    experiment_ = smallFleet();
    experiment_.mission = {verb("take_off"), verb("spell", "H")};
    node_ = std::make_unique<FleetNode>(experiment_, fleet_bus_);
    const auto ignore = [](const bus::DecodeError&) { FAIL() << "the node sent garbage"; };
    bus::subscribe<fleet_status_t>(
        lab_, "FLEET_STATUS",
        [this](const fleet_status_t& message) {
          statuses_.push_back(message);
          order_.push_back("status");
        },
        ignore);
    for (const config::Vehicle& vehicle : experiment_.vehicles) {
      bus::subscribe<roundabout_msgs::goal_t>(
          lab_, "GOAL_" + vehicle.name,
          [this](const roundabout_msgs::goal_t& message) {
            goals_.push_back(message);
            order_.push_back("goal");
          },
          ignore);
    }
  }

  void deliver() {
    fleet_bus_.handle(milliseconds(0));
    lab_.handle(milliseconds(0));
  }

  void sendFrame() {
    core::StatesFrame frame;
    frame.utime = now_ += 5'000;
    for (const config::Vehicle& vehicle : experiment_.vehicles) {
      core::VehicleState state;
      state.name = vehicle.name;
      state.tracked = true;
      state.position_world_m.x() = 3.0 * static_cast<double>(frame.vehicles.size());
      frame.vehicles.push_back(state);
    }
    bus::publish(lab_, bus::kStatesChannel, bus::toMessage(frame));
  }

  roundabout_msgs::planner_status_t plannerStatus(const std::string& vehicle) const {
    roundabout_msgs::planner_status_t status{};
    status.utime = now_;
    status.vehicle = vehicle;
    status.mode = roundabout_msgs::planner_status_t::ON_FLOOR;
    return status;
  }

  void run(double seconds) {
    for (const core::Utime end = now_ + core::toUtime(seconds); now_ < end;) {
      sendFrame();
      if (now_ % 100'000 == 0) {
        for (const config::Vehicle& vehicle : experiment_.vehicles) {
          bus::publish(lab_, "PLANNER_STATUS_" + vehicle.name, plannerStatus(vehicle.name));
        }
      }
      deliver();
    }
  }

  int rejected() {
    run(0.2);
    return statuses_.back().rejected_messages;
  }

  config::Experiment experiment_;
  std::shared_ptr<bus::MemoryNetwork> network_ = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus fleet_bus_{network_};
  bus::MemoryBus lab_{network_};
  std::unique_ptr<FleetNode> node_;
  std::vector<fleet_status_t> statuses_;
  std::vector<roundabout_msgs::goal_t> goals_;
  std::vector<std::string> order_;
  core::Utime now_ = 1'000'000;
};

TEST_F(FleetNodeTest, AnnouncesItselfBeforeTheFirstState) {
  const auto start = std::chrono::steady_clock::now();
  node_->onWallClock(start);
  node_->onWallClock(start + milliseconds(100));
  node_->onWallClock(start + milliseconds(201));
  deliver();
  ASSERT_EQ(statuses_.size(), 2u);
  EXPECT_EQ(statuses_[0].phase, int{fleet_status_t::WAITING});
  EXPECT_EQ(statuses_[0].utime, 0);
  EXPECT_EQ(statuses_[0].reason, "waits for v1's planner, v2's planner, v3's planner");
}

TEST_F(FleetNodeTest, SaysThatFramesHaveStoppedSoThatNobodyFliesBesideIt) {
  const auto start = std::chrono::steady_clock::now();
  run(1.0);
  node_->onWallClock(start);
  statuses_.clear();
  node_->onWallClock(start + milliseconds(1000));
  deliver();
  EXPECT_TRUE(statuses_.empty()) << "a simulator in lockstep may just be waiting";
  for (int ms = 1010; ms < 3010; ms += 50) {
    node_->onWallClock(start + milliseconds(ms));
  }
  deliver();
  ASSERT_EQ(statuses_.size(), 10u) << "at 5 Hz of wall clock";
  EXPECT_EQ(statuses_.back().reason.find("no vehicle states for 3 s"), 0u)
      << statuses_.back().reason;
  EXPECT_EQ(statuses_.back().phase, int{fleet_status_t::TAKE_OFF});
  EXPECT_EQ(statuses_.back().utime, now_) << "of the last tick: no data time has passed";
  EXPECT_EQ(statuses_.back().num_vehicles, 3);

  run(0.2);
  node_->onWallClock(start + milliseconds(3050));
  statuses_.clear();
  node_->onWallClock(start + milliseconds(3300));
  deliver();
  EXPECT_TRUE(statuses_.empty()) << "the frames are back";
}

TEST_F(FleetNodeTest, SendsGoalsBeforeTheStatusOfTheSameTick) {
  run(0.1);
  order_.clear();
  run(0.4);
  ASSERT_GE(order_.size(), 4u);
  const auto first_goal = std::find(order_.begin(), order_.end(), "goal");
  ASSERT_NE(first_goal, order_.end());
  EXPECT_EQ(std::vector<std::string>(first_goal, first_goal + 4),
            (std::vector<std::string>{"goal", "goal", "goal", "status"}));
  const auto status = std::find_if(
      statuses_.begin(), statuses_.end(),
      [](const fleet_status_t& candidate) { return candidate.phase == fleet_status_t::TAKE_OFF; });
  ASSERT_NE(status, statuses_.end());
  EXPECT_EQ(goals_[0].utime, status->utime);
  EXPECT_EQ(goals_[1].vehicle, "v2");
}

TEST_F(FleetNodeTest, ReportsFiveTimesASecondOfDataTime) {
  run(0.3);
  statuses_.clear();
  run(2.0);
  EXPECT_EQ(statuses_.size(), 10u);
  EXPECT_EQ(statuses_.back().phase, int{fleet_status_t::TAKE_OFF});
  EXPECT_EQ(statuses_.back().num_vehicles, 3);
}

TEST_F(FleetNodeTest, ARefusalComesBackInTheStatus) {
  run(1.0);
  roundabout_msgs::mission_t mission{};
  mission.mission_id = 42;
  mission.verb = "dance";
  bus::publish(lab_, "MISSION", mission);
  run(0.4);
  ASSERT_EQ(statuses_.back().num_refusals, 1);
  EXPECT_EQ(statuses_.back().refusals[0].find("mission 42: \"dance\" is no verb"), 0u);
}

TEST_F(FleetNodeTest, APointThatIsNoNumberIsRefused) {
  run(1.0);
  roundabout_msgs::mission_t mission{};
  mission.verb = "formation";
  mission.num_points = 1;
  mission.points = {{std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0}};
  bus::publish(lab_, "MISSION", mission);
  run(0.4);
  ASSERT_EQ(statuses_.back().num_refusals, 1);
  EXPECT_NE(statuses_.back().refusals[0].find("goal 1 is not a number"), std::string::npos);
}

TEST_F(FleetNodeTest, AnOldMissionIsRefusedUnlessItLandsTheFleet) {
  run(1.0);
  roundabout_msgs::mission_t mission{};
  mission.utime = 2'000;
  mission.verb = "wait";
  bus::publish(lab_, "MISSION", mission);
  mission.utime = 1'000;
  mission.mission_id = 7;
  bus::publish(lab_, "MISSION", mission);
  run(0.4);
  ASSERT_EQ(statuses_.back().num_refusals, 1);
  EXPECT_EQ(statuses_.back().refusals[0], "mission 7: older than the mission before it");
  mission.verb = "land";
  bus::publish(lab_, "MISSION", mission);
  run(0.4);
  EXPECT_EQ(goals_.back().phase, int{roundabout_msgs::goal_t::LAND});
}

TEST_F(FleetNodeTest, AStrangerAmongTheVehiclesIsCountedAndTheOthersAreUsed) {
  run(0.5);
  core::StatesFrame frame;
  frame.utime = now_ + 1;
  frame.vehicles.resize(1);
  frame.vehicles[0].name = "v9";
  frame.vehicles[0].tracked = true;
  bus::publish(lab_, "VEHICLE_STATES", bus::toMessage(frame));
  deliver();
  EXPECT_EQ(rejected(), 1);
}

TEST_F(FleetNodeTest, AStatusFromTheFutureDoesNotSilenceAPlanner) {
  run(1.0);
  auto future = plannerStatus("v1");
  future.utime = now_ + 3'600'000'000;
  bus::publish(lab_, "PLANNER_STATUS_v1", future);
  run(3.0);
  EXPECT_EQ(rejected(), 1);
  EXPECT_TRUE(statuses_.back().vehicles[0].planner_alive);
}

TEST_F(FleetNodeTest, AFrameFromTheFutureIsRejectedAndAPauseOfTheCamerasSurvived) {
  run(1.0);
  const core::Utime before = now_;
  now_ += 3'600'000'000;
  sendFrame();
  deliver();
  now_ = before;
  EXPECT_EQ(rejected(), 1);
  statuses_.clear();
  run(1.0);
  EXPECT_EQ(statuses_.size(), 5u);
  now_ += 60'000'000;
  statuses_.clear();
  run(1.0);
  EXPECT_GE(statuses_.size(), 4u);
}

TEST_F(FleetNodeTest, ASimulatorThatIsStartedAnewBeginsTheMissionAnew) {
  run(2.0);
  EXPECT_EQ(statuses_.back().phase, int{fleet_status_t::TAKE_OFF});
  const core::Utime before = now_;
  now_ = 1'000'000;
  goals_.clear();
  run(1.0);
  ASSERT_FALSE(goals_.empty());
  EXPECT_LT(goals_.back().utime, before);
  EXPECT_EQ(goals_.back().phase, int{roundabout_msgs::goal_t::TAKE_OFF});
}

TEST_F(FleetNodeTest, GarbageOnEveryChannelIsCountedAndSurvived) {
  run(0.5);
  const std::vector<std::byte> garbage(200, std::byte{0xa5});
  for (const char* channel : {"VEHICLE_STATES", "MISSION", "PLANNER_STATUS_v1"}) {
    lab_.publish(channel, garbage);
  }
  auto stranger = plannerStatus("v9");
  bus::publish(lab_, "PLANNER_STATUS_v1", stranger);
  auto unknown_mode = plannerStatus("v1");
  unknown_mode.mode = 99;
  bus::publish(lab_, "PLANNER_STATUS_v1", unknown_mode);
  auto old = plannerStatus("v1");
  old.utime = 7;
  bus::publish(lab_, "PLANNER_STATUS_v1", old);
  now_ -= 400'000;
  sendFrame();
  now_ += 400'000;
  deliver();
  EXPECT_EQ(rejected(), 7);
  statuses_.clear();
  run(1.0);
  EXPECT_EQ(statuses_.size(), 5u);
}

}  // namespace
}  // namespace roundabout::fleet
