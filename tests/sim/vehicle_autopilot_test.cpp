#include "sim/vehicle_autopilot.h"

#include <optional>

#include <gtest/gtest.h>

namespace roundabout::sim {
namespace {

using core::CommandMode;
using core::toUtime;

constexpr VehicleAutopilot::Limits kLimits{0.3, 1.0, 0.0, 2.0, true};

class VehicleAutopilotTest : public testing::Test {
 protected:
  std::optional<VehicleAutopilot> autopilot_{kLimits};
  BodyState body_;
  core::Utime now_ = core::kMicrosPerSecond;

  const char* send(CommandMode mode, double age_s = 0.0) {
    core::Command command;
    command.mode = mode;
    command.utime = now_ - toUtime(age_s);
    command.valid_for_s = 0.3;
    command.velocity_world_mps = {1.0, 0.5, 0.0};
    command.position_world_m = {3.0, 2.0, 1.0};
    return autopilot_->accept(command, now_);
  }
  Guidance guidance() { return autopilot_->update(now_, body_).guidance; }
  Guidance after(double seconds) {
    now_ += toUtime(seconds);
    return guidance();
  }
  void beInTheAir() {
    send(CommandMode::kPosition);
    guidance();
    body_.position_world_m = {1.0, 2.0, 1.0};
    body_.on_floor = false;
  }
};

TEST_F(VehicleAutopilotTest, KeepsTheMotorsOffUntilCommanded) {
  EXPECT_EQ(guidance(), Guidance::kMotorsOff);
  EXPECT_EQ(after(10.0), Guidance::kMotorsOff);
}

TEST_F(VehicleAutopilotTest, DoesWhatTheLatestCommandSays) {
  beInTheAir();
  EXPECT_EQ(guidance(), Guidance::kPosition);
  send(CommandMode::kVelocity);
  EXPECT_EQ(guidance(), Guidance::kVelocity);
}

TEST_F(VehicleAutopilotTest, ClipsTheVelocityToTheTopSpeed) {
  beInTheAir();
  core::Command command;
  command.mode = CommandMode::kVelocity;
  command.utime = now_;
  command.valid_for_s = 0.3;
  command.velocity_world_mps = {-30.0, 40.0, 0.0};
  autopilot_->accept(command, now_);
  const Setpoint& setpoint = autopilot_->update(now_, body_);
  EXPECT_NEAR(setpoint.velocity_world_mps.x(), -1.2, 1e-12);
  EXPECT_NEAR(setpoint.velocity_world_mps.y(), 1.6, 1e-12);
}

TEST_F(VehicleAutopilotTest, BrakesFirstWhenToldToHoldThenKeepsThePlace) {
  beInTheAir();
  body_.velocity_world_mps = {1.0, 0.0, 0.0};
  send(CommandMode::kHold);
  EXPECT_EQ(guidance(), Guidance::kBrake);
  body_.velocity_world_mps.setZero();
  body_.position_world_m = {1.4, 2.0, 1.0};
  EXPECT_EQ(guidance(), Guidance::kPosition);
  EXPECT_EQ(autopilot_->update(now_, body_).position_world_m, Eigen::Vector3d(1.4, 2.0, 1.0));
}

TEST_F(VehicleAutopilotTest, DoesNotMoveItsPlaceWhenHoldIsRepeated) {
  beInTheAir();
  send(CommandMode::kHold);
  guidance();
  body_.position_world_m.x() += 0.2;
  now_ += toUtime(0.1);
  send(CommandMode::kHold);
  EXPECT_EQ(autopilot_->update(now_, body_).position_world_m.x(), 1.0);
}

TEST_F(VehicleAutopilotTest, StopsBrakingInTheEndThoughSomethingPushes) {
  beInTheAir();
  body_.velocity_world_mps = {0.5, 0.0, 0.0};
  for (int i = 0; i < 21; ++i) {
    send(CommandMode::kLand);
    EXPECT_EQ(guidance(), Guidance::kBrake);
    now_ += toUtime(0.1);
  }
  EXPECT_EQ(guidance(), Guidance::kDescend);
}

TEST_F(VehicleAutopilotTest, StopsTheMotorsWhenItTouchesTheFloorLanding) {
  beInTheAir();
  send(CommandMode::kLand);
  EXPECT_EQ(guidance(), Guidance::kDescend);
  body_.on_floor = true;
  EXPECT_EQ(guidance(), Guidance::kMotorsOff);
}

TEST_F(VehicleAutopilotTest, HoldsWhenNoCommandCame) {
  beInTheAir();
  send(CommandMode::kVelocity);
  EXPECT_EQ(after(0.3), Guidance::kVelocity);
  EXPECT_EQ(after(0.01), Guidance::kPosition);
}

TEST_F(VehicleAutopilotTest, HoldsWhenTheCommandHasExpiredEarlier) {
  beInTheAir();
  now_ += toUtime(0.2);
  send(CommandMode::kVelocity, 0.2);  // valid for another 0.1 s
  EXPECT_EQ(after(0.1), Guidance::kVelocity);
  EXPECT_EQ(after(0.01), Guidance::kPosition);
}

TEST_F(VehicleAutopilotTest, LandsWhenNoCommandCameForLonger) {
  beInTheAir();
  send(CommandMode::kVelocity);
  EXPECT_EQ(after(1.0), Guidance::kPosition);
  EXPECT_EQ(after(0.01), Guidance::kDescend);
}

TEST_F(VehicleAutopilotTest, FliesOnWhenCommandsComeBack) {
  beInTheAir();
  after(1.1);
  send(CommandMode::kVelocity);
  EXPECT_EQ(guidance(), Guidance::kVelocity);
}

TEST_F(VehicleAutopilotTest, GoesOnLandingWhenCommandsStop) {
  beInTheAir();
  send(CommandMode::kLand);
  guidance();
  EXPECT_EQ(after(0.5), Guidance::kDescend);
}

TEST_F(VehicleAutopilotTest, StopsTheMotorsInTheAirWhenKilledAndLeavesThemOff) {
  beInTheAir();
  send(CommandMode::kKill);
  EXPECT_EQ(guidance(), Guidance::kMotorsOff);
  now_ += toUtime(0.1);
  send(CommandMode::kPosition);
  EXPECT_EQ(guidance(), Guidance::kMotorsOff);
}

TEST_F(VehicleAutopilotTest, TakesOffAgainFromTheFloorAfterAKill) {
  beInTheAir();
  send(CommandMode::kKill);
  guidance();
  body_ = BodyState();
  now_ += toUtime(0.1);
  send(CommandMode::kPosition);
  EXPECT_EQ(guidance(), Guidance::kPosition);
}

TEST_F(VehicleAutopilotTest, RefusesACommandOlderThanTheOneBefore) {
  EXPECT_EQ(send(CommandMode::kPosition, 0.1), nullptr);
  EXPECT_EQ(send(CommandMode::kPosition, 0.1), nullptr);
  EXPECT_STREQ(send(CommandMode::kPosition, 0.2), "older than the command before");
}

TEST_F(VehicleAutopilotTest, RefusesACommandFromTheFarFuture) {
  EXPECT_EQ(send(CommandMode::kPosition, -0.9), nullptr);
  EXPECT_STREQ(send(CommandMode::kPosition, -1.1), "from the future");
}

TEST_F(VehicleAutopilotTest, RefusesACommandThatHasExpired) {
  EXPECT_STREQ(send(CommandMode::kPosition, 0.31), "expired");
}

TEST_F(VehicleAutopilotTest, NeverRefusesKill) {
  beInTheAir();
  EXPECT_EQ(send(CommandMode::kKill, 0.9), nullptr);
  EXPECT_EQ(guidance(), Guidance::kMotorsOff);
}

TEST_F(VehicleAutopilotTest, ObeysNothingBeforeTheCommandDelay) {
  VehicleAutopilot::Limits late = kLimits;
  late.command_delay_s = 0.05;
  autopilot_.emplace(late);
  send(CommandMode::kPosition);
  EXPECT_EQ(after(0.049), Guidance::kMotorsOff);
  EXPECT_EQ(after(0.001), Guidance::kPosition);
}

TEST_F(VehicleAutopilotTest, StartsWithAVelocityIfItDoesNotFly) {
  VehicleAutopilot::Limits ground = kLimits;
  ground.flies = false;
  autopilot_.emplace(ground);
  send(CommandMode::kVelocity);
  EXPECT_EQ(guidance(), Guidance::kVelocity);
}

}  // namespace
}  // namespace roundabout::sim
