#include "cli/flight_director.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace roundabout::cli {
namespace {

class FlightDirectorTest : public testing::Test {
 protected:
  FlightDirectorTest() : director_({"hex1", "hex2"}, limits()) { director_.onFirstState(); }

  static DirectorLimits limits() {
    return {.landing_s = 30.0, .fleet_return_s = 10.0, .sim_linger_s = 2.0};
  }

  void hear(const std::string& vehicle, bool on_floor, double now_s = 1.0) {
    director_.onPlannerHeard(vehicle, on_floor, now_s);
  }

  FlightDirector director_;
};

TEST_F(FlightDirectorTest, GoesOnWhileAllIsWell) {
  EXPECT_EQ(director_.decide(1000.0), Direction::kGoOn);
  EXPECT_EQ(director_.reason(), "");
}

TEST_F(FlightDirectorTest, EndsWhenTheSimulatorHasFinished) {
  director_.onEnd(Role::kSim, "", true, 5.0);
  EXPECT_EQ(director_.decide(5.0), Direction::kEnd);
  EXPECT_EQ(director_.reason(), "");
}

TEST_F(FlightDirectorTest, LingersAfterTheSimulatorDied) {
  director_.onEnd(Role::kSim, "", false, 5.0);
  EXPECT_EQ(director_.decide(6.9), Direction::kGoOn);
  EXPECT_EQ(director_.decide(7.0), Direction::kEnd);
  EXPECT_EQ(director_.reason(), "the simulator died");
}

TEST_F(FlightDirectorTest, GoesOnWithoutAPlanner) {
  director_.onEnd(Role::kPlanner, "hex1", false, 5.0);
  EXPECT_EQ(director_.decide(500.0), Direction::kGoOn);
}

TEST_F(FlightDirectorTest, LandsWhenNoNewFleetTakesOver) {
  director_.onEnd(Role::kFleet, "", false, 5.0);
  EXPECT_EQ(director_.decide(14.9), Direction::kGoOn);
  EXPECT_EQ(director_.decide(15.0), Direction::kLand);
  EXPECT_EQ(director_.reason(), "no new fleet took over");
}

TEST_F(FlightDirectorTest, GoesOnWhenANewFleetIsHeard) {
  director_.onEnd(Role::kFleet, "", false, 5.0);
  director_.onFleetHeard(9.0);
  EXPECT_EQ(director_.decide(500.0), Direction::kGoOn);
}

TEST_F(FlightDirectorTest, DoesNotTakeTheDeadFleetsLastWordForANewFleet) {
  director_.onEnd(Role::kFleet, "", false, 5.0);
  director_.onFleetHeard(5.1);
  EXPECT_EQ(director_.decide(15.0), Direction::kLand);
}

TEST_F(FlightDirectorTest, LandsWhenTheLoggerDied) {
  director_.onEnd(Role::kLogger, "", false, 5.0);
  EXPECT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_EQ(director_.reason(), "the logger died");
}

TEST_F(FlightDirectorTest, LandsWhenTheUserStops) {
  director_.onStop();
  EXPECT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_EQ(director_.reason(), "stopped by the user");
}

TEST_F(FlightDirectorTest, EndsWhenAllAreOnTheFloor) {
  hear("hex1", false);
  hear("hex2", false);
  director_.onStop();
  ASSERT_EQ(director_.decide(5.0), Direction::kLand);
  hear("hex1", true);
  EXPECT_EQ(director_.decide(6.0), Direction::kLand);
  hear("hex2", true);
  EXPECT_EQ(director_.decide(7.0), Direction::kEnd);
}

TEST_F(FlightDirectorTest, DoesNotWaitForAVehicleWhosePlannerIsDead) {
  director_.onEnd(Role::kPlanner, "hex2", false, 4.0);
  director_.onStop();
  ASSERT_EQ(director_.decide(5.0), Direction::kLand);
  hear("hex1", true);
  EXPECT_EQ(director_.decide(6.0), Direction::kEnd);
}

TEST_F(FlightDirectorTest, DoesNotWaitForADeadPlannerBecauseOfItsLastWord) {
  director_.onEnd(Role::kPlanner, "hex2", false, 4.0);
  hear("hex2", false, 4.1);
  hear("hex1", true);
  director_.onStop();
  ASSERT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_EQ(director_.decide(6.0), Direction::kEnd);
}

TEST_F(FlightDirectorTest, WaitsForAPlannerThatWasStartedAgain) {
  director_.onEnd(Role::kPlanner, "hex2", false, 4.0);
  hear("hex2", false, 4.5);
  hear("hex1", true);
  director_.onStop();
  ASSERT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_EQ(director_.decide(6.0), Direction::kLand);
}

TEST_F(FlightDirectorTest, EndsWhenLandingTakesTooLong) {
  director_.onStop();
  ASSERT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_EQ(director_.decide(34.9), Direction::kLand);
  EXPECT_EQ(director_.decide(35.0), Direction::kEnd);
}

TEST_F(FlightDirectorTest, NamesWhoIsStillInTheAirWhenLandingTookTooLong) {
  hear("hex1", true);
  director_.onStop();
  ASSERT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_THAT(director_.notLanded(), testing::IsEmpty());
  ASSERT_EQ(director_.decide(35.0), Direction::kEnd);
  EXPECT_THAT(director_.notLanded(), testing::ElementsAre("hex2"));
}

TEST_F(FlightDirectorTest, LandsWhenTheMissionIsOverAndCallsThatNotEarly) {
  director_.onMissionOver();
  EXPECT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_FALSE(director_.early());
  hear("hex1", true);
  hear("hex2", true);
  EXPECT_EQ(director_.decide(6.0), Direction::kEnd);
}

TEST_F(FlightDirectorTest, LandsWhenTheFlyCommandItselfFails) {
  director_.onFailure("out of memory");
  EXPECT_EQ(director_.decide(5.0), Direction::kLand);
  EXPECT_EQ(director_.reason(), "roundabout fly failed: out of memory");
  EXPECT_TRUE(director_.early());
}

TEST_F(FlightDirectorTest, KeepsTheFirstReasonToLand) {
  director_.onStop();
  director_.onEnd(Role::kLogger, "", false, 5.0);
  EXPECT_EQ(director_.reason(), "stopped by the user");
}

TEST(FlightDirectorBeforeTheFirstStateTest, EndsWithoutLandingWhenTheUserStops) {
  FlightDirector director({"hex1"}, DirectorLimits());
  director.onStop();
  EXPECT_EQ(director.decide(1.0), Direction::kEnd);
}

}  // namespace
}  // namespace roundabout::cli
