#include "fleet/coordinator.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "common/core/error.h"
#include "tests/fleet/small_fleet.h"

namespace roundabout::fleet {
namespace {

/// A fleet whose vehicles obey at once: on every tick each is at the goal it was given on the tick
/// before.
class Flight {
 public:
  explicit Flight(config::Experiment described)
      : experiment(std::move(described)), coordinator(experiment) {
    for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
      core::VehicleState state;
      state.name = experiment.vehicles[i].name;
      state.position_world_m = {2.0 * static_cast<double>(i), -5.0, 0.0};
      state.tracked = true;
      vehicles.push_back(state);
      reports.push_back({1, PlannerMode::kOnFloor, 0});
      stuck.push_back(false);
      silent.push_back(false);
    }
  }

  FleetStatus tick() {
    now += 200'000;
    for (std::size_t i = 0; i < vehicles.size(); ++i) {
      if (!silent[i]) {
        reports[i].utime = now - 100'000;
        coordinator.onPlanner(i, reports[i]);
      }
    }
    core::StatesFrame frame;
    frame.utime = now;
    frame.vehicles = vehicles;
    const Coordinator::Output output = coordinator.tick(frame);
    for (const core::Goal& goal : output.goals) {
      obey(goal);
    }
    goals = output.goals;
    status = output.status;
    history.push_back(status);
    return status;
  }

  FleetStatus run(double seconds) {
    for (double t = 0.0; t < seconds; t += 0.2) {
      tick();
    }
    return status;
  }

  /// Ticks until the phase, at most a minute.
  bool runUntil(Phase phase, const std::string& name = "") {
    for (int i = 0; i < 600; ++i) {
      tick();
      if (status.phase == phase && status.formation == name) {
        return true;
      }
    }
    return false;
  }

  void obey(const core::Goal& goal) {
    for (std::size_t i = 0; i < vehicles.size(); ++i) {
      if (vehicles[i].name != goal.vehicle || silent[i]) {
        continue;
      }
      reports[i].goal_id = goal.goal_id;
      if (stuck[i]) {
        continue;
      }
      vehicles[i].position_world_m = goal.position_world_m;
      reports[i].mode = PlannerMode::kAtGoal;
      if (goal.phase == core::GoalPhase::kLand) {
        vehicles[i].position_world_m.z() = 0.0;
        reports[i].mode = PlannerMode::kLanded;
      }
    }
  }

  config::Experiment experiment;
  Coordinator coordinator;
  std::vector<core::VehicleState> vehicles;
  std::vector<PlannerReport> reports;
  std::vector<bool> stuck;
  std::vector<bool> silent;
  std::vector<core::Goal> goals;
  FleetStatus status;
  std::vector<FleetStatus> history;
  core::Utime now = 1'000'000;
};

config::Experiment withMission(std::vector<config::MissionStep> mission, int count = 3) {
  config::Experiment experiment = smallFleet(count);
  experiment.mission = std::move(mission);
  return experiment;
}

config::Experiment spelling(const std::string& text) {
  return withMission({verb("take_off"), verb("spell", text), verb("land")});
}

TEST(Coordinator, FliesAWordFromTheFloorToTheFloor) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  EXPECT_EQ(flight.status.vehicles_at_goal, 3);
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "I"));
  ASSERT_TRUE(flight.runUntil(Phase::kDone));
  EXPECT_EQ(flight.status.num_steps, 4);
}

TEST(Coordinator, StaysInAFormationForItsTime) {
  Flight flight(spelling("H"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  const core::Utime formed = flight.now;
  ASSERT_TRUE(flight.runUntil(Phase::kLand));
  EXPECT_EQ(flight.now - formed, 2'000'000);
}

TEST(Coordinator, WaitsUntilEveryPlannerHasStates) {
  Flight flight(spelling("H"));
  flight.silent[1] = true;
  EXPECT_EQ(flight.run(3.0).phase, Phase::kWaiting);
  EXPECT_EQ(flight.status.reason, "waits for v2's planner");
  flight.silent[1] = false;
  EXPECT_TRUE(flight.runUntil(Phase::kTakeOff));
}

TEST(Coordinator, ReportsFromThisTickCountFromTheNext) {
  Flight flight(spelling("H"));
  core::StatesFrame frame;
  frame.utime = 2'000'000;
  frame.vehicles = flight.vehicles;
  for (std::size_t i = 0; i < 3; ++i) {
    flight.coordinator.onPlanner(i, {2'000'000, PlannerMode::kOnFloor, 0});
  }
  EXPECT_EQ(flight.coordinator.tick(frame).status.phase, Phase::kWaiting);
  frame.utime = 2'200'000;
  EXPECT_EQ(flight.coordinator.tick(frame).status.phase, Phase::kTakeOff);
}

TEST(Coordinator, TakesEachVehicleUpAboveItsPlace) {
  Flight flight(spelling("H"));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  ASSERT_EQ(flight.goals.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(flight.goals[i].phase, core::GoalPhase::kTakeOff);
    EXPECT_EQ(flight.goals[i].position_world_m,
              Eigen::Vector3d(2.0 * static_cast<double>(i), -5.0, 1.0));
    EXPECT_EQ(flight.goals[i].goal_id, 1000 + static_cast<std::int64_t>(i));
    EXPECT_EQ(flight.goals[i].utime, flight.now);
  }
}

TEST(Coordinator, AVehicleThatStandsBesideTheWallIsSentUpInsideTheRoom) {
  Flight flight(spelling("H"));
  flight.vehicles[0].position_world_m = {-19.9, -20.5, 0.0};
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  EXPECT_EQ(flight.goals[0].position_world_m, Eigen::Vector3d(-19.65, -19.65, 1.0));
}

TEST(Coordinator, AVehicleThatIsToStayBesideTheWallStaysInsideTheRoom) {
  Flight flight(spelling("H"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  flight.vehicles[0].position_world_m = {19.9, 0.0, 1.0};
  flight.coordinator.onMission(1, verb("hold"));
  flight.tick();
  ASSERT_EQ(flight.goals.size(), 3u);
  EXPECT_EQ(flight.goals[0].position_world_m, Eigen::Vector3d(19.65, 0.0, 1.0));
}

TEST(Coordinator, VehiclesThatStandTooCloseAreNotSentUp) {
  Flight flight(spelling("H"));
  flight.vehicles[1].position_world_m = {0.72, -5.0, 0.0};
  ASSERT_TRUE(flight.runUntil(Phase::kFailed));
  EXPECT_EQ(flight.status.reason, "v1 and v2 are 0.72 m apart and must be 1.10 m to take off");
  for (const FleetStatus& status : flight.history) {
    EXPECT_NE(status.phase, Phase::kTakeOff);
  }
}

TEST(Coordinator, ALiveTakeOffOfVehiclesThatStandTooCloseIsRefused) {
  Flight flight(withMission({}));
  flight.vehicles[2].position_world_m = {2.0, -4.5, 0.0};
  flight.run(1.0);
  flight.coordinator.onMission(3, verb("take_off"));
  flight.run(1.0);
  ASSERT_EQ(flight.status.refusals.size(), 1u);
  EXPECT_EQ(flight.status.refusals[0],
            "mission 3: v2 and v3 are 0.50 m apart and must be 1.10 m to take off");
  EXPECT_EQ(flight.status.phase, Phase::kIdle);
}

TEST(Coordinator, StartsExactlyFarEnoughApartMayBeMeasuredALittleCloser) {
  Flight flight(spelling("H"));
  flight.vehicles[1].position_world_m = {1.0995, -5.0, 0.0};
  EXPECT_TRUE(flight.runUntil(Phase::kTakeOff));
}

TEST(Coordinator, RepeatsGoalsOnceASecondUnchanged) {
  Flight flight(spelling("H"));
  flight.stuck = {true, true, true};
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  const core::Utime decided = flight.now;
  int repeated = 0;
  for (int i = 0; i < 25; ++i) {
    flight.tick();
    for (const core::Goal& goal : flight.goals) {
      EXPECT_EQ(goal.utime, decided);
      ++repeated;
    }
  }
  EXPECT_EQ(repeated, 3 * 5);
}

TEST(Coordinator, GivesPointsInOrderWhenAsked) {
  config::Experiment experiment =
      withMission({verb("take_off"), formation("swap", {{4, 0, 1}, {2, 0, 1}, {0, 0, 1}})});
  experiment.fleet.assignment = "in_order";
  Flight flight(experiment);
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "swap"));
  EXPECT_EQ(flight.vehicles[0].position_world_m, Eigen::Vector3d(4, 0, 1));
  EXPECT_EQ(flight.vehicles[2].position_world_m, Eigen::Vector3d(0, 0, 1));
}

TEST(Coordinator, VehiclesWithoutAPointStayWhereTheyAre) {
  config::Experiment experiment = withMission({verb("take_off"), formation("one", {{4, 4, 1}})});
  experiment.fleet.assignment = "in_order";
  Flight flight(experiment);
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "one"));
  EXPECT_EQ(flight.vehicles[1].position_world_m, Eigen::Vector3d(2, -5, 1));
}

TEST(Coordinator, AFormationThatIsNotCompleteInTimeEndsTheFlightOnTheFloor) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  flight.stuck[2] = true;
  flight.run(59.0);
  EXPECT_EQ(flight.status.phase, Phase::kGo);
  flight.run(2.0);
  flight.stuck[2] = false;
  flight.run(2.0);
  EXPECT_EQ(flight.status.phase, Phase::kFailed);
  EXPECT_NE(flight.status.reason.find("\"H\" was not complete after 60 s: v3 is"),
            std::string::npos)
      << flight.status.reason;
  EXPECT_DOUBLE_EQ(flight.vehicles[0].position_world_m.z(), 0.0);
}

TEST(Coordinator, TimeStandsStillWhileAVehicleHolds) {
  Flight flight(spelling("H"));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  flight.stuck[2] = true;
  ASSERT_TRUE(flight.runUntil(Phase::kGo, "H"));
  flight.reports[2].mode = PlannerMode::kHolding;
  EXPECT_EQ(flight.run(200.0).phase, Phase::kGo);
  EXPECT_EQ(flight.status.reason, "v3 holds");
}

TEST(Coordinator, GoesOnWithoutAVehicleWhosePlannerDied) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  flight.silent[1] = true;
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "I"));
  EXPECT_EQ(flight.status.reason, "out: v2 (planner silent)");
  EXPECT_EQ(flight.status.vehicles_at_goal, 2);
}

TEST(Coordinator, IsDoneAndNamesAVehicleWhosePlannerDied) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  flight.silent[1] = true;
  ASSERT_TRUE(flight.runUntil(Phase::kDone));
  EXPECT_EQ(flight.status.reason, "out: v2 (planner silent)");
}

TEST(Coordinator, AMissionThatEndsWithAVehicleKilledHasFailed) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  flight.stuck[1] = true;
  flight.vehicles[1].position_world_m.z() = 0.0;
  flight.reports[1].mode = PlannerMode::kKilled;
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "I")) << "the others go on";
  ASSERT_TRUE(flight.runUntil(Phase::kFailed));
  EXPECT_EQ(flight.status.reason, "landed without: v2 (killed)");
}

TEST(Coordinator, AfterAFailureTheFilesMissionIsOver) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  flight.run(0.4);
  flight.stuck[2] = true;
  flight.run(62.0);
  flight.stuck[2] = false;
  ASSERT_TRUE(flight.runUntil(Phase::kFailed));
  flight.coordinator.onMission(1, verb("take_off"));
  ASSERT_TRUE(flight.runUntil(Phase::kIdle));
  EXPECT_GE(flight.reports[0].goal_id, 1'000'000);
  EXPECT_DOUBLE_EQ(flight.vehicles[0].position_world_m.z(), 1.0);
}

TEST(Coordinator, AVehicleThatTheCamerasDoNotSeeIsNotAtItsGoal) {
  Flight flight(spelling("H"));
  ASSERT_TRUE(flight.runUntil(Phase::kGo, "H"));
  flight.vehicles[1].tracked = false;
  flight.run(3.0);
  EXPECT_EQ(flight.status.phase, Phase::kGo);
  flight.vehicles[1].tracked = true;
  EXPECT_TRUE(flight.runUntil(Phase::kHold, "H"));
}

TEST(Coordinator, APointOnAVehicleThatStaysEndsTheMission) {
  config::Experiment experiment = withMission({verb("take_off"), formation("one", {{2.5, -5, 1}})});
  experiment.fleet.assignment = "in_order";  // v2 stays at (2, -5)
  Flight flight(experiment);
  ASSERT_TRUE(flight.runUntil(Phase::kFailed));
  EXPECT_NE(flight.status.reason.find("there is no point for v2: the point is 0.50 m from v2's"),
            std::string::npos)
      << flight.status.reason;
}

TEST(Coordinator, ALetterIsFlownAtEachVehiclesOwnHeight) {
  config::Experiment experiment = spelling("H");
  experiment.vehicles[2].height_m = 1.5;
  for (experiment.seed = 0; experiment.seed < 6; ++experiment.seed) {
    Flight flight(experiment);
    ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
    EXPECT_DOUBLE_EQ(flight.vehicles[0].position_world_m.z(), 1.0);
    EXPECT_DOUBLE_EQ(flight.vehicles[2].position_world_m.z(), 1.5);
  }
}

TEST(Coordinator, FailsWhenAllWereLandedByTheOperator) {
  Flight flight(spelling("H"));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  flight.run(0.4);
  for (std::size_t i = 0; i < 3; ++i) {
    flight.stuck[i] = true;
    flight.vehicles[i].position_world_m.z() = 0.0;
    flight.reports[i].mode = PlannerMode::kLanded;
  }
  flight.run(1.0);
  EXPECT_EQ(flight.status.phase, Phase::kFailed);
  EXPECT_NE(flight.status.reason.find("no vehicle is left"), std::string::npos);
}

TEST(Coordinator, ARestartedFleetTakesOverAtTheSameStepWithTheSameGoals) {
  Flight flight(spelling("HIT"));
  ASSERT_TRUE(flight.runUntil(Phase::kGo, "I"));
  const std::vector<core::Goal> before = flight.goals;
  ASSERT_EQ(before.size(), 3u);

  Flight second(spelling("HIT"));
  second.now = flight.now + 3'000'000;
  second.vehicles = flight.vehicles;
  second.reports = flight.reports;
  second.stuck = {true, true, true};
  ASSERT_TRUE(second.runUntil(Phase::kGo, "I"));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(second.goals[i].goal_id, before[i].goal_id);
    EXPECT_EQ(second.goals[i].position_world_m, before[i].position_world_m);
  }
}

/// The same lab with a fleet process that was just started.
Flight restarted(const config::Experiment& experiment, const Flight& before) {
  Flight second(experiment);
  second.now = before.now + 3'000'000;
  second.vehicles = before.vehicles;
  second.reports = before.reports;
  return second;
}

TEST(Coordinator, ARestartedFleetFindsTheOptimalAssignmentAgain) {
  config::Experiment experiment = spelling("HI");
  experiment.fleet.assignment = "optimal";
  Flight flight(experiment);
  ASSERT_TRUE(flight.runUntil(Phase::kGo, "H"));
  const std::vector<core::Goal> before = flight.goals;
  ASSERT_EQ(before.size(), 3u);
  // Driven apart on the way: an assignment made here and now would be another.
  std::rotate(flight.vehicles.begin(), flight.vehicles.begin() + 1, flight.vehicles.end());
  for (std::size_t i = 0; i < 3; ++i) {
    flight.vehicles[i].name = experiment.vehicles[i].name;
    flight.vehicles[i].position_world_m += Eigen::Vector3d(0.3, 0.1 * static_cast<double>(i), 0.0);
    flight.reports[i].distance_to_goal_m =
        (flight.vehicles[i].position_world_m - before[i].position_world_m).head<2>().norm();
  }
  Flight second = restarted(experiment, flight);
  second.stuck = {true, true, true};
  ASSERT_TRUE(second.runUntil(Phase::kGo, "H"));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(second.goals[i].goal_id, before[i].goal_id);
    EXPECT_EQ(second.goals[i].position_world_m, before[i].position_world_m);
  }
}

TEST(Coordinator, AFleetRestartedAfterAFailureGoesOnLanding) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  flight.run(0.4);
  flight.stuck[2] = true;
  ASSERT_TRUE(flight.runUntil(Phase::kLand));
  EXPECT_EQ(flight.reports[0].goal_id, 5000) << "four steps, then the landing";
  Flight second = restarted(spelling("HI"), flight);
  ASSERT_TRUE(second.runUntil(Phase::kLand));
  EXPECT_EQ(second.goals[0].phase, core::GoalPhase::kLand);
  EXPECT_TRUE(second.runUntil(Phase::kFailed));
}

TEST(Coordinator, GoalsOfAnotherMissionAreLeftAlone) {
  Flight flight(spelling("H"));
  for (PlannerReport& report : flight.reports) {
    report.goal_id = 77'000;
  }
  flight.run(2.0);
  EXPECT_EQ(flight.status.phase, Phase::kIdle);
  EXPECT_TRUE(flight.goals.empty());
}

TEST(Coordinator, ARestartDuringALiveMissionLeavesTheGoalsAlone) {
  Flight flight(withMission({}));
  for (PlannerReport& report : flight.reports) {
    report.goal_id = 1'003'000;
  }
  flight.run(2.0);
  EXPECT_EQ(flight.status.phase, Phase::kIdle);
  EXPECT_TRUE(flight.goals.empty());
}

TEST(Coordinator, FliesALiveMissionStepByStep) {
  Flight flight(withMission({}));
  flight.run(1.0);
  ASSERT_EQ(flight.status.phase, Phase::kIdle);
  flight.coordinator.onMission(1, verb("take_off"));
  flight.coordinator.onMission(2, verb("spell", "T"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "T"));
  EXPECT_GE(flight.goals.size() + flight.reports.size(), 3u);
  EXPECT_GE(flight.reports[0].goal_id, 1'000'000);
  ASSERT_TRUE(flight.runUntil(Phase::kIdle));
  flight.coordinator.onMission(3, verb("land"));
  ASSERT_TRUE(flight.runUntil(Phase::kIdle));
  EXPECT_DOUBLE_EQ(flight.vehicles[0].position_world_m.z(), 0.0);
}

TEST(Coordinator, WaitsUntilSomebodySaysGoOn) {
  Flight flight(withMission({verb("take_off"), verb("wait_until", "go_on"), verb("land")}));
  flight.coordinator.onMission(1, verb("go_on"));
  flight.run(200.0);
  EXPECT_EQ(flight.status.phase, Phase::kHold) << "no time-out: people take their time";
  EXPECT_EQ(flight.status.reason, "waits for go_on");
  EXPECT_EQ(flight.status.refusals, std::vector<std::string>{"mission 1: nothing waits for go_on"})
      << "said before anybody waited for it";
  flight.coordinator.onMission(2, verb("go_on"));
  EXPECT_EQ(flight.tick().phase, Phase::kLand);
  EXPECT_EQ(flight.status.newest_mission_id, 2);
  EXPECT_EQ(flight.status.finished_mission_id, 0) << "go_on is nothing that is flown";
}

TEST(Coordinator, GoOnLeavesWhatIsQueuedInPlace) {
  Flight flight(withMission({}));
  flight.run(1.0);
  flight.coordinator.onMission(1, verb("take_off"));
  flight.coordinator.onMission(2, verb("wait_until", "go_on"));
  flight.coordinator.onMission(3, verb("spell", "T"));
  flight.run(10.0);
  EXPECT_EQ(flight.status.mission_id, 2);
  flight.coordinator.onMission(4, verb("go_on"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "T"));
  EXPECT_EQ(flight.status.finished_mission_id, 2);
  ASSERT_TRUE(flight.runUntil(Phase::kIdle));
  EXPECT_EQ(flight.status.finished_mission_id, 3);
}

TEST(Coordinator, WaitsUntilATimeSinceTheTakeOff) {
  config::MissionStep until = verb("wait_until");
  until.seconds = 30.0;
  Flight flight(withMission({verb("take_off"), verb("spell", "H"), until, verb("land")}));
  ASSERT_TRUE(flight.runUntil(Phase::kTakeOff));
  const core::Utime took_off = flight.now;
  ASSERT_TRUE(flight.runUntil(Phase::kLand));
  EXPECT_EQ(flight.now - took_off, 30'000'000);
}

TEST(Coordinator, WaitsUntilAllAreAtTheirGoalsAgain) {
  Flight flight(withMission(
      {verb("take_off"), verb("wait", ""), verb("wait_until", "formed"), verb("land")}));
  ASSERT_TRUE(flight.runUntil(Phase::kHold));
  flight.stuck[1] = true;
  flight.vehicles[1].position_world_m.x() += 1.0;
  EXPECT_EQ(flight.run(30.0).phase, Phase::kHold);
  flight.stuck[1] = false;
  EXPECT_TRUE(flight.runUntil(Phase::kLand));
  EXPECT_TRUE(flight.runUntil(Phase::kDone));
}

TEST(Coordinator, NothingElseCanBeWaitedFor) {
  Flight flight(withMission({}));
  flight.run(1.0);
  flight.coordinator.onMission(5, verb("wait_until", "sunrise"));
  flight.tick();
  EXPECT_EQ(flight.status.refusals.back(),
            "mission 5: \"sunrise\" is nothing to wait for: formed, go_on, or seconds since the "
            "take-off are");
}

TEST(Coordinator, ALiveLandDropsWhatIsQueuedAndTheFilesMission) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  flight.coordinator.onMission(1, verb("spell", "AB"));
  flight.coordinator.onMission(2, verb("land"));
  flight.run(10.0);
  EXPECT_EQ(flight.status.phase, Phase::kIdle);
  EXPECT_DOUBLE_EQ(flight.vehicles[0].position_world_m.z(), 0.0);
}

TEST(Coordinator, ALiveOrdersGoalsGoOutOnTheNextTick) {
  Flight flight(spelling("HI"));
  ASSERT_TRUE(flight.runUntil(Phase::kHold, "H"));
  flight.coordinator.onMission(1, verb("land"));
  flight.tick();
  ASSERT_EQ(flight.goals.size(), 3u);
  for (const core::Goal& goal : flight.goals) {
    EXPECT_EQ(goal.phase, core::GoalPhase::kLand);
    EXPECT_EQ(goal.utime, flight.now);
  }
}

TEST(Coordinator, RefusalsSayWhy) {
  Flight flight(withMission({}));
  flight.run(1.0);
  flight.coordinator.onMission(4, verb("dance"));
  flight.coordinator.onMission(5, formation("x", {{0, 0, 1}, {0, 0.4, 1}}));
  flight.coordinator.onMission(6, verb("spell", "H"));
  config::MissionStep go_to = verb("go_to");
  go_to.vehicle = "v9";
  go_to.points_m = {{0, 0, 1}};
  flight.coordinator.onMission(7, go_to);
  flight.tick();
  ASSERT_EQ(flight.status.refusals.size(), 4u);
  EXPECT_NE(flight.status.refusals[0].find("\"dance\" is no verb"), std::string::npos);
  EXPECT_EQ(flight.status.refusals[1],
            "mission 5: goals 1 and 2 are 0.40 m apart and must be 1.10 m");
  std::sort(flight.status.refusals.begin(), flight.status.refusals.end());
  EXPECT_EQ(flight.status.refusals[2], "mission 6: all vehicles are on the floor: take off first");
  EXPECT_NE(flight.status.refusals[3].find("no vehicle \"v9\""), std::string::npos);
}

TEST(Coordinator, AGoToOntoAnothersGoalIsRefused) {
  Flight flight(withMission({}));
  flight.run(1.0);
  flight.coordinator.onMission(1, verb("take_off"));
  flight.run(3.0);
  config::MissionStep go_to = verb("go_to");
  go_to.vehicle = "v1";
  go_to.points_m = {{2.0, -5.5, 1.0}};  // v2 is at (2, -5)
  flight.coordinator.onMission(2, go_to);
  flight.run(1.0);
  ASSERT_EQ(flight.status.refusals.size(), 1u);
  EXPECT_NE(flight.status.refusals[0].find("0.50 m from v2's goal"), std::string::npos);
  EXPECT_EQ(flight.status.phase, Phase::kIdle);
}

TEST(Coordinator, SaysWhatBecameOfAMessage) {
  Flight flight(withMission({}));
  flight.run(1.0);
  flight.coordinator.onMission(11, verb("take_off"));
  flight.coordinator.onMission(12, verb("spell", "HI"));
  flight.tick();
  EXPECT_EQ(flight.status.newest_mission_id, 12);
  EXPECT_EQ(flight.status.mission_id, 11);
  EXPECT_EQ(flight.status.finished_mission_id, 0);
  ASSERT_TRUE(flight.runUntil(Phase::kGo, "H"));
  EXPECT_EQ(flight.status.mission_id, 12);
  EXPECT_EQ(flight.status.finished_mission_id, 11);
  ASSERT_TRUE(flight.runUntil(Phase::kGo, "I"));
  EXPECT_EQ(flight.status.finished_mission_id, 11);  // half of it is not all of it
  ASSERT_TRUE(flight.runUntil(Phase::kIdle));
  EXPECT_EQ(flight.status.finished_mission_id, 12);
  EXPECT_EQ(flight.status.mission_id, 0);
  flight.coordinator.onMission(13, verb("dance"));
  flight.tick();
  EXPECT_EQ(flight.status.newest_mission_id, 13);
  EXPECT_EQ(flight.status.finished_mission_id, 12);
}

TEST(Coordinator, WhatALandDropsIsRefusedOnce) {
  Flight flight(withMission({}));
  flight.run(1.0);
  flight.coordinator.onMission(1, verb("take_off"));
  flight.run(3.0);
  flight.coordinator.onMission(2, verb("spell", "HI"));
  flight.coordinator.onMission(3, verb("spell", "HI"));
  flight.tick();
  flight.coordinator.onMission(4, verb("land"));
  flight.tick();
  EXPECT_EQ(flight.status.refusals,
            (std::vector<std::string>{"mission 2: dropped by land", "mission 3: dropped by land"}));
  EXPECT_EQ(flight.status.mission_id, 4);
  flight.run(3.0);
  EXPECT_EQ(flight.status.finished_mission_id, 4);
}

TEST(Coordinator, KeepsTheLatestTenRefusals) {
  Flight flight(withMission({}));
  flight.run(1.0);
  for (int i = 0; i < 25; ++i) {
    flight.coordinator.onMission(i, verb("dance"));
  }
  flight.tick();
  ASSERT_EQ(flight.status.refusals.size(), 10u);
  EXPECT_EQ(flight.status.refusals.back().find("mission 24:"), 0u);
}

TEST(Coordinator, AFilesMissionThatCannotBeFlownEndsTheStart) {
  const auto expectStartupError = [](const config::Experiment& experiment,
                                     const std::string& text) {
    try {
      Coordinator coordinator(experiment);
      FAIL() << text;
    } catch (const core::StartupError& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  expectStartupError(withMission({verb("take_off"), formation("x", {{0, 0, 1}, {0, 0.4, 1}})}),
                     "mission[1].formation: expected something that can be flown, found goals 1 "
                     "and 2 are 0.40 m apart and must be 1.10 m");
  expectStartupError(withMission({verb("take_off"), formation("x", {{0, 0, 1}, {3, 0, 1}})}, 1),
                     "2 goals are more than 1 vehicles");
  expectStartupError(withMission({verb("spell", "A")}), "take_off before anything in the air");
  expectStartupError(withMission({verb("take_off"), verb("spell", "A\x07")}), "no strokes");
  expectStartupError(withMission({verb("take_off"), verb("land"), verb("hold")}),
                     "mission[2].hold: expected take_off before anything in the air");
  expectStartupError(withMission(std::vector<config::MissionStep>(999, verb("wait"))),
                     "mission[998].wait: expected at most 998 steps");
}

TEST(Coordinator, VehiclesThatDriveNeedNoTakeOff) {
  config::Experiment experiment = withMission({formation("x", {{0, 0, 1}, {3, 0, 1}, {6, 0, 1}})});
  for (config::Vehicle& vehicle : experiment.vehicles) {
    vehicle.model = "unicycle";
  }
  Flight flight(experiment);
  EXPECT_TRUE(flight.runUntil(Phase::kHold, "x"));
}

}  // namespace
}  // namespace roundabout::fleet
