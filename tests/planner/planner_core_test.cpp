#include "planner/planner_core.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/core/error.h"
#include "tests/planner/fake_flight.h"
#include "tests/support/startup_error.h"

namespace roundabout::planner {
namespace {

using core::CommandMode;
using core::GoalPhase;
using core::SafetyOrderKind;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(PlannerCore, AnswersEveryTenthOfASecondWithOneCommand) {
  FakeFlight flight;
  flight.run(0.1);  // the first frame is answered wherever it lies
  flight.ticks.clear();
  flight.run(1.0);
  EXPECT_EQ(flight.ticks.size(), 10u);
  for (const auto& tick : flight.ticks) {
    EXPECT_EQ(tick.command.utime, tick.command.state_utime);
    EXPECT_EQ(tick.command.utime, tick.status.utime);
    EXPECT_EQ(tick.command.utime % 100'000, 0);
  }
}

TEST(PlannerCore, RefusesAVehicleThatTheExperimentDoesNotHave) {
  EXPECT_THROW(PlannerCore(threeVehicles(), "hex9", nullptr), core::StartupError);
}

TEST(PlannerCore, HoldsOnTheFloorUntilThereIsAGoal) {
  FakeFlight flight;
  const auto tick = flight.run(0.5);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_EQ(tick.status.mode, Mode::kOnFloor);
}

TEST(PlannerCore, AGoalTakesEffectAtTheFirstTickAfterItsStamp) {
  FakeFlight flight;
  flight.run(0.1);  // now is a tick
  flight.goal(GoalPhase::kTakeOff, {0.0, 0.0, 1.0});
  const auto next = flight.run(0.1);
  EXPECT_EQ(next.command.utime, 1'200'000);
  EXPECT_EQ(next.status.mode, Mode::kTakingOff);
}

TEST(PlannerCore, TakesOffByPositionAboveItsPlace) {
  FakeFlight flight;
  flight.run(0.1);
  flight.goal(GoalPhase::kTakeOff, {0.0, 0.0, 1.0});
  const auto tick = flight.run(0.2);
  EXPECT_EQ(tick.command.mode, CommandMode::kPosition);
  EXPECT_EQ(tick.command.position_world_m, Eigen::Vector3d(0.0, 0.0, 1.0));
}

TEST(PlannerCore, WillNotGoFromTheFloor) {
  FakeFlight flight;
  flight.run(0.1);
  flight.goal(GoalPhase::kGo, {4.0, 0.0, 1.0});
  const auto tick = flight.run(0.2);
  EXPECT_EQ(tick.status.mode, Mode::kOnFloor);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_EQ(flight.script->calls, 0);
}

TEST(PlannerCore, FliesWhatThePolicySays) {
  FakeFlight flight;
  flight.script->decision = {.speed_mps = 0.4, .heading_change_rad = 0.5};
  flight.flyTo({4.0, 0.0, 1.0});
  const auto tick = flight.run(0.1);
  EXPECT_EQ(tick.status.mode, Mode::kFlying);
  EXPECT_EQ(tick.command.mode, CommandMode::kVelocity);
  EXPECT_NEAR(tick.command.velocity_world_mps.norm(), 0.4, 1e-9);
  EXPECT_NEAR(tick.command.heading_world_rad, 0.5, 1e-9);
  EXPECT_DOUBLE_EQ(tick.command.position_world_m.z(), 1.0);
  EXPECT_EQ(flight.script->others.size(), 2u);
  EXPECT_DOUBLE_EQ(flight.script->ego.radius_m, 0.5);
}

TEST(PlannerCore, TheCommandNeverExceedsThePreferredSpeed) {
  FakeFlight flight;
  flight.script->decision.speed_mps = 50.0;
  flight.flyTo({4.0, 0.0, 1.0});
  EXPECT_NEAR(flight.run(0.1).command.velocity_world_mps.norm(), 0.5, 1e-9);
}

TEST(PlannerCore, HoldsPositionOnTheGoalWithinThirtyCentimetres) {
  FakeFlight flight;
  flight.flyTo({0.29, 0.0, 1.0});
  const auto tick = flight.run(0.1);
  EXPECT_EQ(tick.status.mode, Mode::kAtGoal);
  EXPECT_EQ(tick.command.mode, CommandMode::kPosition);
  EXPECT_EQ(tick.command.position_world_m, Eigen::Vector3d(0.29, 0.0, 1.0));
}

TEST(PlannerCore, LandsAndReportsIt) {
  FakeFlight flight;
  flight.flyTo({0.2, 0.0, 1.0});
  flight.goal(GoalPhase::kLand, {0.0, 0.0, 0.0}, 3);
  EXPECT_EQ(flight.run(0.2).status.mode, Mode::kLanding);
  while (flight.own().position_world_m.z() > 0.0) {
    flight.own().position_world_m.z() -= 0.1;
    flight.run(0.005);
  }
  const auto tick = flight.run(0.2);
  EXPECT_EQ(tick.status.mode, Mode::kLanded);
  EXPECT_EQ(tick.command.mode, CommandMode::kLand);
}

TEST(PlannerCore, ANumberThatIsNoneFromThePolicyBecomesAHold) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.script->decision.heading_change_rad = kNaN;
  const auto tick = flight.run(0.1);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_TRUE(tick.command.velocity_world_mps.allFinite());
  EXPECT_EQ(tick.status.rejected_messages, 1);
}

TEST(PlannerCore, HoldsWhenItsVehicleIsNotTrackedAndLandsWhenThatLasts) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().tracked = false;
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kHold);
  EXPECT_EQ(flight.run(0.3).command.mode, CommandMode::kLand);
  flight.own().tracked = true;
  EXPECT_EQ(flight.run(0.5).command.mode, CommandMode::kLand) << "a landing that has begun goes on";
}

TEST(PlannerCore, ACommandOnAnAgeingStateExpiresWhenTheStateIsTooOld) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  EXPECT_DOUBLE_EQ(flight.run(0.1).command.valid_for_s, 0.3);
  flight.own().tracked = false;
  const auto tick = flight.run(0.1);
  ASSERT_EQ(tick.command.mode, CommandMode::kVelocity);
  EXPECT_NEAR(tick.status.state_age_s + tick.command.valid_for_s, 0.15, 1e-9);
}

TEST(PlannerCore, FliesOnWhenTrackingReturnsInTime) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().tracked = false;
  flight.run(0.2);
  flight.own().tracked = true;
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, AnUntrackedNeighbourGrowsWithItsTopSpeed) {
  FakeFlight flight;
  flight.vehicles[1].velocity_world_mps = {-0.5, 0.0, 0.0};
  flight.flyTo({4.0, 0.0, 1.0});
  flight.vehicles[1].tracked = false;
  flight.run(0.4);
  ASSERT_EQ(flight.script->others.size(), 2u);
  const double age_s = (flight.script->others[0].radius_m - 0.5) / 2.0;
  EXPECT_GT(age_s, 0.3);
  EXPECT_LE(age_s, 0.4);
  EXPECT_NEAR(flight.script->others[0].position_world_m.x(), 3.0 - 0.5 * age_s, 1e-9);
}

TEST(PlannerCore, AnUntrackedNeighbourGrowsForASecondAndNoMore) {
  FakeFlight flight;
  flight.flyTo({0.0, 4.0, 1.0});
  flight.vehicles[1].tracked = false;  // 3 m away
  flight.run(60.0);
  EXPECT_NEAR(flight.script->others[0].radius_m, 0.5 + 2.0 * 1.0, 1e-9);
}

TEST(PlannerCore, DoesNotFlyWhileANeighbourWasNeverSeen) {
  FakeFlight flight;
  flight.vehicles[1].tracked = false;
  flight.run(0.1);
  flight.goal(GoalPhase::kTakeOff, {0.0, 0.0, 1.0});
  const auto tick = flight.run(0.3);
  EXPECT_EQ(tick.status.mode, Mode::kOnFloor);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_EQ(tick.status.reason, "hex2 was never tracked");
}

TEST(PlannerCore, DoesNotTakeOffBesideALostNeighbour) {
  FakeFlight flight;
  flight.vehicles[1].position_world_m.x() = 1.9;
  flight.run(0.1);
  flight.vehicles[1].tracked = false;
  flight.run(1.1);
  flight.goal(GoalPhase::kTakeOff, {0.0, 0.0, 1.0});
  EXPECT_EQ(flight.run(0.3).command.mode, CommandMode::kHold);
}

TEST(PlannerCore, LandsAlsoBesideALostNeighbour) {
  FakeFlight flight;
  flight.vehicles[1].position_world_m.x() = 1.9;
  flight.flyTo({0.0, 4.0, 1.0});
  flight.vehicles[1].tracked = false;
  EXPECT_EQ(flight.run(1.2).command.mode, CommandMode::kHold);
  flight.goal(GoalPhase::kLand, {0.0, 0.0, 0.0}, 3);
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, GoesOnLandingWhenItsVehicleIsNoLongerSeen) {
  for (const double height_m : {1.0, 0.1}) {
    FakeFlight flight;
    flight.flyTo({0.2, 0.0, 1.0});
    flight.goal(GoalPhase::kLand, {0.0, 0.0, 0.0}, 3);
    for (double z = 1.0; z > height_m; z -= 0.02) {
      flight.own().position_world_m.z() = z;
      flight.own().velocity_world_mps.z() = -0.4;
      flight.run(0.05);
    }
    flight.own().tracked = false;
    for (int tick = 0; tick < 20; ++tick) {
      EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kLand);
    }
    EXPECT_EQ(flight.core.onSilence(0.2).command.mode, CommandMode::kLand);
  }
}

TEST(PlannerCore, ATakeOffThatGoesBlindNearTheFloorLands) {
  FakeFlight flight;
  flight.run(0.1);
  flight.goal(GoalPhase::kTakeOff, {0.0, 0.0, 1.0});
  flight.run(0.2);
  flight.own().position_world_m.z() = 0.1;
  flight.run(0.1);
  flight.own().tracked = false;
  EXPECT_EQ(flight.run(0.3).command.mode, CommandMode::kHold);
  EXPECT_EQ(flight.run(0.3).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, IsNotLandedInTheAirBecauseItWasOnce) {
  FakeFlight flight;
  flight.order(SafetyOrderKind::kLand);
  EXPECT_EQ(flight.run(0.2).status.mode, Mode::kLanded);
  flight.order(SafetyOrderKind::kResume);
  flight.flyTo({4.0, 0.0, 1.0});
  flight.order(SafetyOrderKind::kLand);
  EXPECT_EQ(flight.run(0.1).status.mode, Mode::kLanding);
}

TEST(PlannerCore, ALostTrackHoldsFirst) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().position_world_m.x() += 1.0;
  flight.run(0.05);
  flight.own().tracked = false;
  auto tick = flight.run(0.1);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_EQ(tick.status.reason, "own track is lost");
  EXPECT_EQ(flight.run(0.4).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, HoldsNearANeighbourThatIsLostForASecond) {
  FakeFlight flight;
  flight.vehicles[1].position_world_m.x() = 1.9;
  flight.flyTo({0.0, 4.0, 1.0});
  flight.vehicles[1].tracked = false;
  EXPECT_EQ(flight.run(0.9).command.mode, CommandMode::kVelocity);
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kHold);
}

TEST(PlannerCore, FliesOnWhenALostNeighbourIsFarAway) {
  FakeFlight flight;
  flight.flyTo({0.0, 4.0, 1.0});
  flight.vehicles[1].tracked = false;  // 3 m away
  EXPECT_EQ(flight.run(1.5).command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, OrdersAreLatchedUntilResume) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.order(SafetyOrderKind::kHold);
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kHold);
  EXPECT_EQ(flight.run(5.0).command.mode, CommandMode::kHold);
  flight.order(SafetyOrderKind::kResume);
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, AnOrderForAnotherVehicleIsNotMine) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.order(SafetyOrderKind::kLand, "hex2");
  const auto tick = flight.run(0.1);
  EXPECT_EQ(tick.command.mode, CommandMode::kVelocity);
  EXPECT_EQ(tick.status.rejected_messages, 0);
}

TEST(PlannerCore, AnOrderForAnUnknownVehicleIsCounted) {
  FakeFlight flight;
  flight.order(SafetyOrderKind::kLand, "hex9");
  EXPECT_EQ(flight.run(0.1).status.rejected_messages, 1);
}

TEST(PlannerCore, AnOldResumeIsRefusedAndAnOldLandIsObeyed) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.order(SafetyOrderKind::kHold);
  flight.core.onOrder({.utime = 5, .vehicle = "", .order = SafetyOrderKind::kResume});
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kHold);
  flight.core.onOrder({.utime = 5, .vehicle = "", .order = SafetyOrderKind::kLand});
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, ARepeatedResumeLiftsNothingThatWasLatchedSince) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  const core::SafetyOrder resume{flight.now + 1, "", SafetyOrderKind::kResume};
  flight.core.onOrder(resume);
  ASSERT_EQ(flight.run(0.1).command.mode, CommandMode::kVelocity);
  flight.vehicles[0].tracked = false;
  ASSERT_EQ(flight.run(0.7).command.mode, CommandMode::kLand);
  flight.vehicles[0].tracked = true;
  flight.core.onOrder(resume);
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, AHoldThatIsRepeatedDoesNotEndALandingOrderedSince) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  const core::SafetyOrder hold{flight.now + 1, "", SafetyOrderKind::kHold};
  flight.core.onOrder(hold);
  flight.core.onOrder({flight.now + 2, "", SafetyOrderKind::kLand});
  flight.core.onOrder(hold);
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kLand);
  EXPECT_EQ(flight.core.obeyedOrder(), hold.utime + 1);
}

TEST(PlannerCore, AResumeThatIsRepeatedDoesNotLiftAKillWithAnOlderStamp) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  const core::SafetyOrder resume{flight.now + 10, "", SafetyOrderKind::kResume};
  flight.core.onOrder(resume);
  flight.core.onOrder({flight.now + 8, "", SafetyOrderKind::kKill});  // by a clock that is behind
  flight.core.onOrder(resume);
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kKill);
}

TEST(PlannerCore, AResumeWithACorruptStampIsRefused) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.order(SafetyOrderKind::kHold);
  flight.core.onOrder({std::numeric_limits<core::Utime>::max(), "", SafetyOrderKind::kResume});
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kHold);
}

TEST(PlannerCore, SaysWhyAResumeIsRefused) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.order(SafetyOrderKind::kHold);
  flight.core.onOrder({.utime = 5, .vehicle = "", .order = SafetyOrderKind::kResume});
  EXPECT_EQ(flight.run(0.1).status.reason,
            "ordered to hold; a resume older than the last order was refused");
}

TEST(PlannerCore, AnOrderWithACorruptStampDoesNotForbidResuming) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.core.onOrder({.utime = std::numeric_limits<core::Utime>::max(),
                       .vehicle = "",
                       .order = SafetyOrderKind::kHold});
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kHold);
  flight.order(SafetyOrderKind::kResume);
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, KillIsObeyedInEveryState) {
  for (const auto earlier :
       {SafetyOrderKind::kHold, SafetyOrderKind::kLand, SafetyOrderKind::kResume}) {
    FakeFlight flight;
    flight.flyTo({4.0, 0.0, 1.0});
    flight.order(earlier);
    flight.order(SafetyOrderKind::kKill);
    flight.order(SafetyOrderKind::kHold);
    EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kKill);
  }
}

TEST(PlannerCore, ARestartInTheAirNeedsAResume) {
  FakeFlight flight;
  flight.own().position_world_m.z() = 1.0;
  flight.run(0.1);
  flight.goal(GoalPhase::kGo, {4.0, 0.0, 1.0});
  auto tick = flight.run(0.3);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_NE(tick.status.reason.find("resume"), std::string::npos);
  flight.order(SafetyOrderKind::kResume);
  tick = flight.run(0.1);
  EXPECT_EQ(tick.command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, ARestartInTheAirIsNoticedWhenItsVehicleIsSeen) {
  FakeFlight flight;
  flight.own().position_world_m.z() = 1.0;
  flight.own().tracked = false;
  flight.run(0.3);
  flight.own().tracked = true;
  flight.run(0.1);
  flight.goal(GoalPhase::kGo, {4.0, 0.0, 1.0});
  const auto tick = flight.run(0.3);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_NE(tick.status.reason.find("resume"), std::string::npos);
}

TEST(PlannerCore, AResumeThatComesBeforeTheRepeatedGoalCounts) {
  FakeFlight flight;
  const core::Utime before = flight.now - 500'000;
  flight.own().position_world_m.z() = 1.0;
  flight.run(0.1);
  flight.order(SafetyOrderKind::kResume);
  flight.run(0.1);
  core::Goal repeated{.utime = before, .vehicle = "hex1", .goal_id = 1};
  repeated.position_world_m = {4.0, 0.0, 1.0};
  repeated.phase = GoalPhase::kGo;
  flight.core.onGoal(repeated);
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, TheTimeGoingBackInTheAirNeedsAResume) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.now = 500'000;
  flight.run(0.05);
  auto tick = flight.run(0.1);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_FALSE(tick.status.goal.has_value());
}

TEST(PlannerCore, ASimulatorStartedAnewIsFlownWith) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().position_world_m.z() = 0.0;
  flight.now = 500'000;
  flight.run(0.1);
  flight.flyTo({4.0, 0.0, 1.0});
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, ARestartOnTheFloorDuringAFlightNeedsAResume) {
  FakeFlight flight;
  flight.goal(GoalPhase::kTakeOff, {0.0, 0.0, 1.0});  // fleet repeats what it sent before
  auto tick = flight.run(0.3);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_NE(tick.status.reason.find("resume"), std::string::npos);
  flight.order(SafetyOrderKind::kResume);
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kPosition);
}

TEST(PlannerCore, OldFramesAreRejectedAndCounted) {
  FakeFlight flight;
  flight.run(0.5);
  flight.now -= 50'000;
  EXPECT_FALSE(flight.frame());
  EXPECT_FALSE(flight.frame());
  flight.now += 100'000;
  EXPECT_EQ(flight.run(0.1).status.rejected_messages, 2);
}

TEST(PlannerCore, OneCorruptStampDoesNotBlindIt) {
  FakeFlight flight;
  flight.run(0.5);
  const core::Utime good = flight.now;
  flight.now = good * 1000;
  EXPECT_FALSE(flight.frame());
  flight.now = good;
  flight.ticks.clear();
  flight.run(0.5);
  EXPECT_EQ(flight.ticks.size(), 5u);
}

TEST(PlannerCore, AnUnknownVehicleInAFrameIsCounted) {
  FakeFlight flight;
  flight.vehicles.push_back(flight.vehicles[0]);
  flight.vehicles.back().name = "stranger";
  EXPECT_GT(flight.run(0.1).status.rejected_messages, 0);
}

TEST(PlannerCore, OldGoalsAndGoalsOutsideTheRoomAreRefused) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  const int before = flight.run(0.1).status.rejected_messages;
  flight.core.onGoal({.utime = 5, .vehicle = "hex1", .goal_id = 9, .phase = GoalPhase::kLand});
  flight.goal(GoalPhase::kGo, {40.0, 0.0, 1.0}, 10);
  flight.core.onGoal(
      {.utime = flight.now * 1000, .vehicle = "hex1", .goal_id = 11, .phase = GoalPhase::kLand});
  const auto tick = flight.run(0.2);
  EXPECT_EQ(tick.status.rejected_messages, before + 3);
  EXPECT_EQ(tick.status.goal->goal_id, 2);
  EXPECT_EQ(tick.command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, GoalsWithImpossibleStampsAreRefused) {
  FakeFlight flight;
  flight.run(0.1);
  for (const core::Utime utime :
       {std::numeric_limits<core::Utime>::min(), std::numeric_limits<core::Utime>::max()}) {
    EXPECT_STREQ(flight.core.onGoal({.utime = utime, .vehicle = "hex1", .goal_id = 9}),
                 "its time stamp is corrupt");
  }
}

TEST(PlannerCore, AGoalALittleOutsideTheRoomIsMovedToItsEdge) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.goal(GoalPhase::kGo, {5.2, 0.0, 1.0}, 3);
  const auto tick = flight.run(0.2);
  ASSERT_EQ(tick.status.goal->goal_id, 3);
  EXPECT_NEAR(tick.status.goal->position_world_m.x(), 5.0 - 0.35, 1e-9);
}

TEST(PlannerCore, AGoalOnTheFloorIsNoGoalToFlyTo) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.goal(GoalPhase::kGo, {3.0, 0.0, 0.0}, 3);
  EXPECT_EQ(flight.run(0.2).status.goal->goal_id, 2);
}

TEST(PlannerCore, ATakeOffToSomewhereElseIsRefused) {
  FakeFlight flight;
  flight.run(0.1);
  flight.goal(GoalPhase::kTakeOff, {2.0, 0.0, 1.0});
  auto tick = flight.run(0.2);
  EXPECT_EQ(tick.status.mode, Mode::kOnFloor);
  EXPECT_EQ(tick.status.reason, "a take-off goal 2.0 m away was refused");
  flight.goal(GoalPhase::kTakeOff, {0.3, 0.0, 1.0}, 2);
  EXPECT_EQ(flight.run(0.2).status.mode, Mode::kTakingOff);
}

TEST(PlannerCore, AVehicleThatWasCarriedAwayDoesNotTakeOffForItsOldPlace) {
  FakeFlight flight;
  flight.run(0.1);
  flight.order(SafetyOrderKind::kHold);
  flight.goal(GoalPhase::kTakeOff, {0.0, 0.0, 1.0});
  flight.run(0.2);
  for (double x = 0.0; x < 2.0; x += 0.1) {
    flight.own().position_world_m.x() = x;
    flight.run(0.005);
  }
  flight.order(SafetyOrderKind::kResume);
  const auto tick = flight.run(0.2);
  EXPECT_EQ(tick.status.mode, Mode::kOnFloor);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
}

TEST(PlannerCore, ALostNeighbourThatWasComingCountsWhereItMayBe) {
  FakeFlight flight;
  flight.vehicles[1].position_world_m.x() = 2.9;
  flight.vehicles[1].velocity_world_mps = {-1.5, 0.0, 0.0};
  flight.flyTo({0.0, 4.0, 1.0});
  flight.vehicles[1].tracked = false;
  EXPECT_EQ(flight.run(1.2).command.mode, CommandMode::kHold);
}

TEST(PlannerCore, SlowsDownBeforeTheEdgeOfTheRoom) {
  FakeFlight flight;
  flight.flyTo({4.6, 0.0, 1.0});
  flight.own().velocity_world_mps = {0.5, 0.0, 0.0};
  double x = 0.0;
  while (x < 4.55) {  // the wall is at 5, the body reaches 0.35
    x += 0.01;
    flight.own().position_world_m.x() = x;
    flight.run(0.005);
  }
  flight.goal(GoalPhase::kGo, {0.0, 4.0, 1.0}, 7);  // the policy still says straight on
  flight.script->decision = {.speed_mps = 0.5, .heading_change_rad = 0.0};
  const auto tick = flight.run(0.2);
  EXPECT_LT(tick.command.velocity_world_mps.x(), 0.3);
  EXPECT_FALSE(tick.status.reason.empty());
}

TEST(PlannerCore, LandsFarOutsideTheRoom) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  for (double x = 0.0; x < 5.6; x += 0.1) {
    flight.own().position_world_m.x() = x;
    flight.run(0.005);
  }
  EXPECT_EQ(flight.run(0.1).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, SilenceHoldsThenLandsForGood) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  auto tick = flight.core.onSilence(0.15);
  EXPECT_EQ(tick.command.mode, CommandMode::kHold);
  EXPECT_EQ(tick.command.utime, flight.now + 150'000);
  EXPECT_EQ(tick.command.state_utime, flight.now);
  EXPECT_EQ(flight.core.onSilence(0.5).command.mode, CommandMode::kLand);
  flight.now += 600'000;
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, AGapInTheStatesThatOnlyALogShowsLandsToo) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.now += 600'000;
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kLand);
}

TEST(PlannerCore, AShortGapInTheStatesIsFlownThrough) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.now += 400'000;
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kVelocity);
}

TEST(PlannerCore, ANewGoalResetsThePolicysMemory) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  const int resets = flight.script->resets;
  flight.goal(GoalPhase::kGo, {4.0, 0.0, 1.0}, 2);  // a repetition
  flight.run(0.2);
  EXPECT_EQ(flight.script->resets, resets);
  flight.goal(GoalPhase::kGo, {3.0, 0.0, 1.0}, 3);
  flight.run(0.2);
  EXPECT_EQ(flight.script->resets, resets + 1);
}

TEST(PlannerCore, TellsItsPolicyOfTheObstacles) {
  config::Experiment experiment = threeVehicles();
  experiment.obstacles = {{"box", {{1.0, 3.0}, {2.0, 3.0}, {2.0, 4.0}}}};
  FakeFlight flight(experiment);
  flight.flyTo({4.0, 0.0, 1.0});
  ASSERT_EQ(flight.script->obstacles.size(), 1U);
  EXPECT_EQ(flight.script->obstacles[0], experiment.obstacles[0].points_m);
}

TEST(PlannerCore, RefusesObstaclesThatItsPolicyDoesNotAvoid) {
  config::Experiment experiment = threeVehicles();
  experiment.obstacles = {{"box", {{1.0, 3.0}, {2.0, 3.0}, {2.0, 4.0}}}};
  const auto script = std::make_shared<ScriptedPolicy::Script>();
  script->avoids_obstacles = false;
  const auto make = [&] {
    PlannerCore(experiment, "hex1", std::make_unique<ScriptedPolicy>(script));
  };
  EXPECT_NO_THROW(make()) << "the shield keeps it off them";
  experiment.shield.on = false;
  EXPECT_EQ(test::startupErrorOf(make),
            "test: obstacles: expected none, since the policy scripted does not avoid them and the "
            "shield is off, found 1");
}

// hex1 flies by its lidar.
struct ScanningFlight : FakeFlight {
  ScanningFlight() : FakeFlight(withLidar(), scanning()) {}

  static config::Experiment withLidar() {
    config::Experiment experiment = threeVehicles();
    experiment.vehicles[0].lidar = config::Lidar{};
    experiment.vehicles[0].lidar->max_range_m = 5.0;
    return experiment;
  }
  static std::shared_ptr<ScriptedPolicy::Script> scanning() {
    const auto script = std::make_shared<ScriptedPolicy::Script>();
    script->needs_scan = true;
    return script;
  }

  const char* scan(core::Utime utime, float range_m) {
    return core.onScan({utime, -1.0, 0.5, {range_m, range_m}});
  }
};

TEST(PlannerCore, FliesByTheNewestScanFromBeforeTheTick) {
  ScanningFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  const core::Utime tick = flight.now / 100'000 * 100'000 + 100'000;
  EXPECT_EQ(flight.scan(tick - 50'000, 1.0F), nullptr);
  EXPECT_EQ(flight.scan(tick - 25'000, 2.0F), nullptr);
  EXPECT_EQ(flight.scan(tick, 3.0F), nullptr);  // as of the tick: for the next one
  flight.run(core::toSeconds(tick - flight.now));
  EXPECT_EQ(flight.ticks.back().status.mode, Mode::kFlying);
  EXPECT_EQ(flight.script->ranges_m, (std::vector{2.0F, 2.0F}));
  EXPECT_EQ(flight.script->max_range_m, 5.0);
  flight.run(0.1);
  EXPECT_EQ(flight.script->ranges_m, (std::vector{3.0F, 3.0F}));
}

TEST(PlannerCore, HoldsWithoutAFreshScan) {
  ScanningFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  EXPECT_EQ(flight.ticks.back().status.mode, Mode::kHolding);
  EXPECT_EQ(flight.ticks.back().status.reason, "no laser scan");
  EXPECT_EQ(flight.script->calls, 0);

  flight.scan(flight.now / 100'000 * 100'000, 1.0F);
  for (const Mode expected : {Mode::kFlying, Mode::kFlying, Mode::kFlying, Mode::kHolding}) {
    EXPECT_EQ(flight.run(0.1).status.mode, expected);
  }
  EXPECT_EQ(flight.ticks.back().command.mode, CommandMode::kHold);
}

TEST(PlannerCore, LandsWithoutAScanToo) {
  ScanningFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.goal(GoalPhase::kLand, {0.0, 0.0, 0.0}, 3);
  EXPECT_EQ(flight.run(0.2).status.mode, Mode::kLanding);
}

TEST(PlannerCore, RefusesScansFromNoSuchTimeAndKeepsNoMoreThanItNeeds) {
  ScanningFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  EXPECT_NE(flight.scan(-1, 1.0F), nullptr);
  EXPECT_NE(flight.scan(flight.now + 3600 * core::kMicrosPerSecond, 1.0F), nullptr);
  // Scans of the near future push out all others: the vehicle holds.
  flight.scan(flight.now, 1.0F);
  for (int i = 0; i < 1000; ++i) {
    flight.scan(flight.now + core::kMicrosPerSecond, 1.0F);
  }
  EXPECT_EQ(flight.run(0.1).status.reason, "no laser scan");
}

TEST(PlannerCore, RefusesAPolicyThatScansOnAVehicleWithoutLidar) {
  EXPECT_EQ(test::startupErrorOf([&] {
              PlannerCore(threeVehicles(), "hex1",
                          std::make_unique<ScriptedPolicy>(ScanningFlight::scanning()));
            }),
            "test: vehicles[0].lidar: expected one, since the policy scripted flies by it, found "
            "none");
}

TEST(PlannerCore, WhoHeldInASilenceSaysThatItWillMoveBeforeItDoes) {
  FakeFlight flight;
  flight.flyTo({4.0, 0.0, 1.0});
  flight.own().position_world_m.x() = 0.6;  // hex2 is near
  flight.run(0.3);
  EXPECT_GT(flight.run(0.1).command.velocity_world_mps.norm(), 0.1);
  flight.now += core::toUtime(0.3);  // no frames: the vehicle was told to hold
  const std::size_t before = flight.ticks.size();
  flight.run(0.1);
  const PlannerCore::Tick first = flight.ticks.at(before);
  ASSERT_EQ(first.status.mode, Mode::kFlying) << first.status.reason;
  EXPECT_EQ(first.command.velocity_world_mps.norm(), 0.0) << "others take it for parked";
  EXPECT_GT(flight.run(0.1).command.velocity_world_mps.norm(), 0.1);
}

TEST(PlannerCore, AVehicleThatDrivesNeedsNoTakeOff) {
  config::Experiment experiment = threeVehicles();
  experiment.vehicles[0].model = "unicycle";
  FakeFlight flight(experiment);
  flight.run(0.1);
  flight.goal(GoalPhase::kGo, {4.0, 0.0, 0.0});
  EXPECT_EQ(flight.run(0.2).command.mode, CommandMode::kVelocity);
}

}  // namespace
}  // namespace roundabout::planner
