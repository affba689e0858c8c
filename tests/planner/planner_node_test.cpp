#include "planner/planner_node.h"

#include <limits>

#include <gtest/gtest.h>

#include "common/bus/memory_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "roundabout_msgs/planner_status_t.hpp"
#include "tests/planner/fake_flight.h"

namespace roundabout::planner {
namespace {

using std::chrono::milliseconds;

/// hex1's planner node, and somebody who talks to it.
class PlannerNodeTest : public ::testing::Test {
 protected:
  explicit PlannerNodeTest(const std::string& pacing = "real_time") {
    experiment_ = threeVehicles();
    experiment_.sim.pacing = pacing;
    node_ = std::make_unique<PlannerNode>(experiment_, "hex1",
                                          std::make_unique<ScriptedPolicy>(script_), planner_bus_);
    const auto ignore = [](const bus::DecodeError&) { FAIL() << "the node sent garbage"; };
    bus::subscribe<roundabout_msgs::command_t>(
        lab_, "COMMAND_hex1",
        [this](const roundabout_msgs::command_t& message) { commands_.push_back(message); },
        ignore);
    bus::subscribe<roundabout_msgs::planner_status_t>(
        lab_, "PLANNER_STATUS_hex1",
        [this](const roundabout_msgs::planner_status_t& message) { statuses_.push_back(message); },
        ignore);
  }

  void deliver() {
    planner_bus_.handle(milliseconds(0));
    lab_.handle(milliseconds(0));
  }

  core::StatesFrame frameAt(core::Utime utime) const {
    core::StatesFrame frame;
    frame.utime = utime;
    for (const config::Vehicle& vehicle : experiment_.vehicles) {
      core::VehicleState state;
      state.name = vehicle.name;
      state.tracked = true;
      state.last_seen = utime;
      state.position_world_m.x() = 2.0 * static_cast<double>(frame.vehicles.size());
      frame.vehicles.push_back(state);
    }
    return frame;
  }

  void sendFrames(int count) {
    for (int i = 0; i < count; ++i) {
      bus::publish(lab_, bus::kStatesChannel, bus::toMessage(frameAt(now_ += 5'000)));
    }
    deliver();
  }

  void wait(milliseconds time) {
    node_->onWallClock(std::chrono::steady_clock::now() + time);
    deliver();
  }

  void sendGarbage(const std::string& channel) {
    const std::vector<std::byte> garbage(100, std::byte{0x5a});
    lab_.publish(channel, garbage);
    std::vector<std::byte> cut = bus::encode(bus::toMessage(frameAt(now_)));
    cut.resize(cut.size() / 2);
    lab_.publish(channel, cut);
    deliver();
  }

  config::Experiment experiment_;
  std::shared_ptr<bus::MemoryNetwork> network_ = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus planner_bus_{network_};
  bus::MemoryBus lab_{network_};
  std::shared_ptr<ScriptedPolicy::Script> script_ = std::make_shared<ScriptedPolicy::Script>();
  std::unique_ptr<PlannerNode> node_;
  std::vector<roundabout_msgs::command_t> commands_;
  std::vector<roundabout_msgs::planner_status_t> statuses_;
  core::Utime now_ = 1'000'000;
};

TEST_F(PlannerNodeTest, AnnouncesItselfBeforeTheFirstState) {
  wait(milliseconds(0));
  wait(milliseconds(50));
  wait(milliseconds(101));
  ASSERT_EQ(statuses_.size(), 2u);
  EXPECT_EQ(statuses_[0].mode, int{roundabout_msgs::planner_status_t::WAITING});
  EXPECT_EQ(statuses_[0].utime, 0);
  EXPECT_TRUE(commands_.empty());
}

TEST_F(PlannerNodeTest, AnswersEveryTickWithACommandAndAStatus) {
  sendFrames(200);
  ASSERT_EQ(commands_.size(), 11u) << "the first frame, and ten ticks";
  ASSERT_EQ(statuses_.size(), 11u);
  EXPECT_EQ(commands_[3].utime, statuses_[3].utime);
  EXPECT_EQ(statuses_[3].policy, "scripted");
}

TEST_F(PlannerNodeTest, FollowsAGoal) {
  sendFrames(20);
  core::Goal goal{.utime = now_, .vehicle = "hex1", .goal_id = 7};
  goal.position_world_m = {0.0, 0.0, 1.0};
  bus::publish(lab_, "GOAL_hex1", bus::toMessage(goal));
  sendFrames(40);
  EXPECT_EQ(commands_.back().mode, int{roundabout_msgs::command_t::POSITION});
  EXPECT_EQ(statuses_.back().goal_id, 7);
}

TEST_F(PlannerNodeTest, CommandsHoldWhenStatesStopComing) {
  sendFrames(20);
  commands_.clear();
  wait(milliseconds(135));
  EXPECT_TRUE(commands_.empty());
  wait(milliseconds(145));  // the next call may come 10 ms later, and that would be too late
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].mode, int{roundabout_msgs::command_t::HOLD});
  EXPECT_EQ(commands_[0].state_utime, now_);
  wait(milliseconds(160));
  EXPECT_EQ(commands_.size(), 1u) << "repeated at 10 Hz only";
}

TEST_F(PlannerNodeTest, LandsWhenStatesStayAway) {
  for (int i = 0; i < 20; ++i) {
    core::StatesFrame frame = frameAt(now_ += 5'000);
    frame.vehicles[0].position_world_m.z() = 1.0;
    bus::publish(lab_, bus::kStatesChannel, bus::toMessage(frame));
  }
  deliver();
  wait(milliseconds(460));
  wait(milliseconds(495));
  ASSERT_GE(commands_.size(), 2u);
  EXPECT_EQ(commands_.back().mode, int{roundabout_msgs::command_t::LAND});
}

class LockstepPlannerNodeTest : public PlannerNodeTest {
 protected:
  LockstepPlannerNodeTest() : PlannerNodeTest("lockstep") {}
};

TEST_F(LockstepPlannerNodeTest, SilenceMeansNothing) {
  sendFrames(20);
  commands_.clear();
  wait(milliseconds(5000));
  EXPECT_TRUE(commands_.empty());
}

TEST_F(LockstepPlannerNodeTest, IsHeardOfByWhoeverBeginsTheNextFlight) {
  sendFrames(20);
  commands_.clear();
  statuses_.clear();
  wait(milliseconds(900));
  EXPECT_TRUE(statuses_.empty());
  wait(milliseconds(1100));
  wait(milliseconds(1300));
  EXPECT_EQ(statuses_.size(), 2u);
  EXPECT_TRUE(commands_.empty());
}

TEST_F(LockstepPlannerNodeTest, SaysWhichOrderItObeyedAlsoWhenFramesHaveStopped) {
  sendFrames(20);
  bus::publish(lab_, "SAFETY_ORDER",
               bus::toMessage(core::SafetyOrder{70, "", core::SafetyOrderKind::kHold}));
  deliver();
  wait(milliseconds(1100));
  EXPECT_EQ(statuses_.back().order_utime, 70);
}

TEST_F(PlannerNodeTest, KillIsSentAtOnceAlsoBeforeTheFirstState) {
  core::SafetyOrder kill;
  kill.utime = 5;
  kill.order = core::SafetyOrderKind::kKill;
  bus::publish(lab_, "SAFETY_ORDER", bus::toMessage(kill));
  deliver();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].mode, int{roundabout_msgs::command_t::KILL});
  EXPECT_EQ(statuses_.back().mode, int{roundabout_msgs::planner_status_t::KILLED});
  wait(milliseconds(200));
  EXPECT_EQ(commands_.size(), 2u) << "and again, in case it was not heard";
}

TEST_F(LockstepPlannerNodeTest, KillIsSentAtOnceAlsoWhenFramesHaveStopped) {
  sendFrames(20);
  commands_.clear();
  core::SafetyOrder kill;
  kill.order = core::SafetyOrderKind::kKill;
  bus::publish(lab_, "SAFETY_ORDER", bus::toMessage(kill));
  deliver();
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].mode, int{roundabout_msgs::command_t::KILL});
}

TEST_F(PlannerNodeTest, GarbageOnEveryChannelIsCountedAndSurvived) {
  sendFrames(20);
  for (const std::string channel : {"VEHICLE_STATES", "GOAL_hex1", "SAFETY_ORDER"}) {
    sendGarbage(channel);
  }
  sendFrames(20);
  EXPECT_EQ(statuses_.back().rejected_messages, 6);
}

TEST_F(PlannerNodeTest, NumbersThatAreNoneAreCountedAndSurvived) {
  sendFrames(20);
  core::StatesFrame frame = frameAt(now_ += 5'000);
  frame.vehicles[1].position_world_m.x() = std::numeric_limits<double>::quiet_NaN();
  bus::publish(lab_, bus::kStatesChannel, bus::toMessage(frame));
  core::Goal goal{.utime = now_, .vehicle = "hex1", .goal_id = 7};
  goal.position_world_m.x() = std::numeric_limits<double>::infinity();
  bus::publish(lab_, "GOAL_hex1", bus::toMessage(goal));
  auto order = bus::toMessage(core::SafetyOrder{});
  order.order = 77;
  bus::publish(lab_, "SAFETY_ORDER", order);
  sendFrames(20);
  EXPECT_EQ(statuses_.back().rejected_messages, 3);
  EXPECT_EQ(statuses_.back().goal_id, 0);
}

TEST_F(PlannerNodeTest, AGoalForAnotherVehicleOnMyChannelIsRejected) {
  sendFrames(20);
  bus::publish(lab_, "GOAL_hex1",
               bus::toMessage(core::Goal{.utime = now_, .vehicle = "hex2", .goal_id = 7}));
  sendFrames(40);
  EXPECT_EQ(statuses_.back().goal_id, 0);
  EXPECT_EQ(statuses_.back().rejected_messages, 1);
}

TEST_F(PlannerNodeTest, ObeysAnOrderAtTheNextTick) {
  sendFrames(20);
  core::SafetyOrder kill;
  kill.order = core::SafetyOrderKind::kKill;
  bus::publish(lab_, "SAFETY_ORDER", bus::toMessage(kill));
  sendFrames(20);
  EXPECT_EQ(commands_.back().mode, int{roundabout_msgs::command_t::KILL});
}

TEST_F(PlannerNodeTest, SaysWhichOrderItObeyed) {
  const auto send = [this](core::Utime utime, const std::string& vehicle) {
    bus::publish(lab_, "SAFETY_ORDER",
                 bus::toMessage(core::SafetyOrder{utime, vehicle, core::SafetyOrderKind::kHold}));
    deliver();
  };
  send(70, "hex1");
  send(80, "hex2");
  wait(milliseconds(0));
  EXPECT_EQ(statuses_.back().order_utime, 70) << "before the first state too";
  send(90, "");
  sendFrames(20);
  EXPECT_EQ(statuses_.back().order_utime, 90);
}

TEST(PlannerNodeScans, ReachThePolicyAndHostileOnesAreCounted) {
  config::Experiment experiment = threeVehicles();
  experiment.vehicles[0].lidar = config::Lidar{};
  experiment.vehicles[0].model = "unicycle";  // needs no take-off
  auto script = std::make_shared<ScriptedPolicy::Script>();
  script->needs_scan = true;
  const auto network = std::make_shared<bus::MemoryNetwork>();
  bus::MemoryBus planner_bus(network);
  bus::MemoryBus lab(network);
  PlannerNode node(experiment, "hex1", std::make_unique<ScriptedPolicy>(script), planner_bus);
  int rejected = -1;
  bus::subscribe<roundabout_msgs::planner_status_t>(
      lab, "PLANNER_STATUS_hex1",
      [&](const roundabout_msgs::planner_status_t& status) { rejected = status.rejected_messages; },
      [](const bus::DecodeError&) { FAIL(); });

  core::StatesFrame frame;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    core::VehicleState state;
    state.name = vehicle.name;
    state.tracked = true;
    state.position_world_m.x() = 2.0 * static_cast<double>(frame.vehicles.size());
    frame.vehicles.push_back(state);
  }
  const auto send = [&](core::Utime utime) {
    frame.utime = utime;
    for (core::VehicleState& state : frame.vehicles) {
      state.last_seen = utime;
    }
    bus::publish(lab, bus::kStatesChannel, bus::toMessage(frame));
  };
  send(1'000'000);
  bus::publish(lab, bus::goalChannel("hex1"),
               bus::toMessage(core::Goal{.utime = 1'000'000,
                                         .vehicle = "hex1",
                                         .goal_id = 1,
                                         .position_world_m = {-4.0, 0.0, 0.0},
                                         .heading_world_rad = 0.0,
                                         .phase = core::GoalPhase::kGo}));
  std::vector<std::byte> scan =
      bus::encode(bus::toMessage(core::LaserScan{1'050'000, -1.0, 0.1, {1.5F, 2.5F}}));
  lab.publish("LASER_SCAN_hex1", scan);
  scan[16] = std::byte{0x7f};
  lab.publish("LASER_SCAN_hex1", scan);
  send(1'100'000);
  planner_bus.handle(milliseconds(0));
  lab.handle(milliseconds(0));
  EXPECT_EQ(script->ranges_m, (std::vector{1.5F, 2.5F}));
  EXPECT_EQ(rejected, 1);
}

}  // namespace
}  // namespace roundabout::planner
