#include "common/bus/messages.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/bus/typed.h"
#include "tests/common/bus/sample_messages.h"

namespace roundabout::bus {
namespace {

const double kNotNumbers[] = {std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity()};

// ---- a struct becomes a message and the same struct again

TEST(Messages, AStatesFrameSurvivesTheWire) {
  core::StatesFrame frame;
  const auto message = sample<roundabout_msgs::vehicle_states_t>();
  EXPECT_EQ(fromMessage(message, frame), 0);
  EXPECT_EQ(frame.utime, 1'005'000);
  ASSERT_EQ(frame.vehicles.size(), 2u);
  EXPECT_EQ(frame.vehicles[1].name, "hex2");
  EXPECT_EQ(frame.vehicles[1].position_world_m, Eigen::Vector3d(2.5, 0.0, 1.0));
  EXPECT_EQ(frame.vehicles[0].velocity_world_mps, Eigen::Vector3d(0.0, -0.5, 0.0));
  EXPECT_NEAR(core::headingOf(frame.vehicles[0].orientation), 2.0 * std::atan2(0.8, 0.6), 1e-12);
  EXPECT_EQ(frame.vehicles[0].angular_velocity_body_radps.z(), 0.25);
  EXPECT_TRUE(frame.vehicles[0].tracked);
  EXPECT_EQ(frame.vehicles[0].last_seen, 1'005'000);
  EXPECT_EQ(encode(toMessage(frame)), encode(message));
}

TEST(Messages, ACommandSurvivesTheWire) {
  core::Command command;
  const auto message = sample<roundabout_msgs::command_t>();
  ASSERT_EQ(fromMessage(message, command), nullptr);
  EXPECT_EQ(command.mode, core::CommandMode::kPosition);
  EXPECT_EQ(command.velocity_world_mps.x(), 0.5);
  EXPECT_EQ(command.valid_for_s, 0.3);
  EXPECT_EQ(encode(toMessage(command)), encode(message));
}

TEST(Messages, AGoalSurvivesTheWire) {
  core::Goal goal;
  const auto message = sample<roundabout_msgs::goal_t>();
  ASSERT_EQ(fromMessage(message, goal), nullptr);
  EXPECT_EQ(goal.phase, core::GoalPhase::kGo);
  EXPECT_EQ(goal.goal_id, 1000);
  EXPECT_EQ(encode(toMessage(goal)), encode(message));
}

TEST(Messages, ALaserScanSurvivesTheWire) {
  core::LaserScan scan;
  auto message = sample<roundabout_msgs::planar_lidar_t>();
  message.nintensities = 0;
  message.intensities.clear();
  ASSERT_EQ(fromMessage(message, scan), nullptr);
  EXPECT_EQ(scan.utime, 1'005'000);
  EXPECT_EQ(scan.first_angle_rad, -1.5);
  EXPECT_EQ(scan.ranges_m, (std::vector{1.5F, 6.0F, 0.25F}));
  EXPECT_EQ(encode(toMessage(scan)), encode(message));
}

TEST(Messages, ALaserScanWithBrokenAnglesOrTooManyRangesIsRefused) {
  core::LaserScan scan;
  auto message = sample<roundabout_msgs::planar_lidar_t>();
  message.rad0 = std::numeric_limits<float>::quiet_NaN();
  EXPECT_STREQ(fromMessage(message, scan), "an angle is not finite");
  message = sample<roundabout_msgs::planar_lidar_t>();
  message.radstep = std::numeric_limits<float>::infinity();
  EXPECT_STREQ(fromMessage(message, scan), "an angle is not finite");
  message = sample<roundabout_msgs::planar_lidar_t>();
  message.nranges = kMostRanges + 1;
  message.ranges.resize(static_cast<std::size_t>(message.nranges));
  EXPECT_STREQ(fromMessage(message, scan), "more ranges than any lidar has");
}

TEST(Messages, ASafetyOrderSurvivesTheWire) {
  core::SafetyOrder order;
  const auto message = sample<roundabout_msgs::safety_order_t>();
  ASSERT_EQ(fromMessage(message, order), nullptr);
  EXPECT_EQ(order.order, core::SafetyOrderKind::kLand);
  EXPECT_EQ(encode(toMessage(order)), encode(message));
}

TEST(Messages, EveryModePhaseAndOrderIsKnown) {
  for (std::int8_t mode = 0; mode <= roundabout_msgs::command_t::KILL; ++mode) {
    auto message = sample<roundabout_msgs::command_t>();
    message.mode = mode;
    core::Command command;
    ASSERT_EQ(fromMessage(message, command), nullptr);
    EXPECT_EQ(toMessage(command).mode, mode);
  }
  EXPECT_EQ(static_cast<int>(core::GoalPhase::kLand), int{roundabout_msgs::goal_t::LAND});
  EXPECT_EQ(static_cast<int>(core::SafetyOrderKind::kResume),
            int{roundabout_msgs::safety_order_t::RESUME});
}

// ---- what is not acceptable

TEST(Messages, ABrokenVehicleIsUntrackedAndBlindsNobodyToTheOthers) {
  using State = roundabout_msgs::vehicle_state_t;
  const auto breaks = {
      +[](State& state, double value) { state.position[1] = value; },
      +[](State& state, double value) { state.velocity[2] = value; },
      +[](State& state, double value) { state.orientation[3] = value; },
      +[](State& state, double value) { state.angular_velocity[0] = value; },
  };
  for (const auto& breakIt : breaks) {
    for (const double value : kNotNumbers) {
      auto message = sample<roundabout_msgs::vehicle_states_t>();
      breakIt(message.vehicles[0], value);
      core::StatesFrame frame;
      EXPECT_EQ(fromMessage(message, frame), 1);
      EXPECT_FALSE(frame.vehicles[0].tracked);
      EXPECT_EQ(frame.vehicles[0].name, "hex1");
      EXPECT_EQ(frame.vehicles[0].position_world_m, Eigen::Vector3d(0.0, 0.0, 0.0));
      EXPECT_TRUE(frame.vehicles[1].tracked);
    }
  }
}

TEST(Messages, AnOrientationThatIsNoRotationMakesAVehicleUntracked) {
  for (const double w : {0.0, 0.5, 2.0}) {
    auto message = sample<roundabout_msgs::vehicle_states_t>();
    for (double& element : message.vehicles[1].orientation) {
      element = 0.0;
    }
    message.vehicles[1].orientation[0] = w;
    core::StatesFrame frame;
    EXPECT_EQ(fromMessage(message, frame), 1);
    EXPECT_FALSE(frame.vehicles[1].tracked);
  }
}

TEST(Messages, AFrameForgetsTheOneBefore) {
  core::StatesFrame frame;
  fromMessage(sample<roundabout_msgs::vehicle_states_t>(), frame);
  roundabout_msgs::vehicle_states_t empty{};
  EXPECT_EQ(fromMessage(empty, frame), 0);
  EXPECT_TRUE(frame.vehicles.empty());
}

TEST(Messages, ACommandWithANumberThatIsNotFiniteIsRefused) {
  using Message = roundabout_msgs::command_t;
  const auto breaks = {
      +[](Message& message, double value) { message.velocity[0] = value; },
      +[](Message& message, double value) { message.position[2] = value; },
      +[](Message& message, double value) { message.heading = value; },
      +[](Message& message, double value) { message.heading_rate = value; },
      +[](Message& message, double value) { message.valid_for = value; },
  };
  for (const auto& breakIt : breaks) {
    for (const double value : kNotNumbers) {
      auto message = sample<Message>();
      breakIt(message, value);
      core::Command command;
      EXPECT_STREQ(fromMessage(message, command), "not a finite number");
      EXPECT_TRUE(command.vehicle.empty()) << "filled by a refused message";
    }
  }
}

TEST(Messages, ModesPhasesAndOrdersThatDoNotExistAreRefused) {
  for (const std::int8_t wrong : {-128, -1, 5, 127}) {
    auto command_message = sample<roundabout_msgs::command_t>();
    command_message.mode = wrong;
    core::Command command;
    EXPECT_STREQ(fromMessage(command_message, command), "unknown mode");
    auto goal_message = sample<roundabout_msgs::goal_t>();
    goal_message.phase = wrong;
    core::Goal goal;
    EXPECT_STREQ(fromMessage(goal_message, goal), "unknown phase");
    auto order_message = sample<roundabout_msgs::safety_order_t>();
    order_message.order = wrong;
    core::SafetyOrder order;
    EXPECT_STREQ(fromMessage(order_message, order), "unknown order");
  }
}

TEST(Messages, AGoalMayLeaveTheHeadingOpenButNotThePosition) {
  auto message = sample<roundabout_msgs::goal_t>();
  message.heading = std::numeric_limits<double>::quiet_NaN();
  core::Goal goal;
  ASSERT_EQ(fromMessage(message, goal), nullptr);
  EXPECT_TRUE(std::isnan(goal.heading_world_rad));

  message.heading = std::numeric_limits<double>::infinity();
  EXPECT_STREQ(fromMessage(message, goal), "not a finite number");
  for (const double value : kNotNumbers) {
    message = sample<roundabout_msgs::goal_t>();
    message.position[0] = value;
    EXPECT_STREQ(fromMessage(message, goal), "not a finite number");
  }
}

TEST(Channels, AreNamedAfterTheVehicle) {
  EXPECT_EQ(goalChannel("hex1"), "GOAL_hex1");
  EXPECT_EQ(commandChannel("hex1"), "COMMAND_hex1");
  EXPECT_EQ(plannerStatusChannel("hex1"), "PLANNER_STATUS_hex1");
}

}  // namespace
}  // namespace roundabout::bus
