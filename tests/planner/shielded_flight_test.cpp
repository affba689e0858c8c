// Planner nodes and the simulator on an in-memory bus: whatever policies want, nobody touches
// anybody, and what has to be free becomes free.

#include "tests/planner/shielded_flight.h"

#include <gtest/gtest.h>

namespace roundabout::planner {
namespace {

const Eigen::Vector2d kMiddle(0.0, 0.0);

std::unique_ptr<Policy> chasers(std::size_t) { return chaser(); }
std::unique_ptr<Policy> straight(std::size_t) { return straightToTheGoal(); }

void sendAcross(ShieldedFlight& flight, const config::Experiment& experiment) {
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    flight.goTo(i, -experiment.vehicles[i].start->position_m);
  }
}

// Somewhere far from all, so that policies are asked for all the flight.
void sendFarAway(ShieldedFlight& flight, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    flight.goTo(i, {i % 2 == 0 ? 5.5 : -5.5, i % 4 < 2 ? 5.5 : -5.5});
  }
}

TEST(ShieldedFlight, WhoFliesAtTheNearestNeverTouchesIt) {
  const config::Experiment experiment = circleOf(6, 2.5);
  ShieldedFlight flight(experiment, chasers);
  flight.takeOff();
  sendFarAway(flight, 6);
  flight.run(20.0);
  EXPECT_GT(flight.closestM(), 0.0);
  EXPECT_LT(flight.closestM(), 0.4) << "they did try";
  EXPECT_GT(flight.interventions(0), 10);
}

TEST(ShieldedFlight, WithoutTheShieldTheyTouch) {
  config::Experiment experiment = circleOf(6, 2.5);
  experiment.shield.on = false;
  ShieldedFlight flight(experiment, chasers);
  flight.takeOff();
  sendFarAway(flight, 6);
  flight.run(10.0);
  EXPECT_LT(flight.closestM(), 0.0);
  EXPECT_EQ(flight.interventions(0), 0);
}

TEST(ShieldedFlight, WhoFliesAtRandomTouchesNobodyAndNoWall) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    config::Experiment experiment = circleOf(8, 2.0);
    experiment.room.min_m = {-3.0, -3.0, 0.0};
    experiment.room.max_m = {3.0, 3.0, 3.0};
    ShieldedFlight flight(experiment, [&](std::size_t i) { return drunkard(100 * seed + i); });
    flight.takeOff();
    sendFarAway(flight, 8);
    flight.run(10.0);
    EXPECT_GT(flight.closestM(), 0.0) << seed;
    EXPECT_GT(flight.closestStaticM(), 0.0) << seed;
  }
}

TEST(ShieldedFlight, APushOfAQuarterMetreASecondIsNoCollision) {
  for (int from = 0; from < 6; ++from) {
    config::Experiment experiment = circleOf(6, 2.0);
    for (int i = 0; i < 40; ++i) {
      const double angle = 2.4 * (i + from);
      experiment.sim.pushes.push_back({"hex" + std::to_string(1 + i % 6), 5.0 + 0.4 * i, 0.1,
                                       2.5 * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
    }
    ShieldedFlight flight(experiment, chasers);
    flight.takeOff();
    sendFarAway(flight, 6);
    flight.run(18.0);
    EXPECT_GT(flight.closestM(), 0.0) << from;
  }
}

TEST(ShieldedFlight, LostTrackingIsNoCollision) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    config::Experiment experiment = circleOf(6, 2.0);
    experiment.seed = seed;
    experiment.sim.mocap.dropout = {0.2, 0.15};
    ShieldedFlight flight(experiment, chasers);
    flight.takeOff();
    sendFarAway(flight, 6);
    flight.run(20.0);
    EXPECT_GT(flight.closestM(), 0.0) << seed;
  }
}

TEST(ShieldedFlight, AVehicleWhosePlannerDiesIsFlownRound) {
  const config::Experiment experiment = circleOf(6, 2.5);
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  sendAcross(flight, experiment);
  flight.run(1.0);
  flight.killPlanner(2);
  flight.run(40.0);
  EXPECT_GT(flight.closestM(), 0.0);
  EXPECT_LT(flight.heightOf(2), 0.1);
  for (std::size_t i = 0; i < 6; ++i) {
    if (i != 2 && (-experiment.vehicles[i].start->position_m - flight.place(2)).norm() > 1.0) {
      EXPECT_TRUE(flight.isNear(i, -experiment.vehicles[i].start->position_m)) << i;
    }
  }
}

TEST(ShieldedFlight, AWholeCircleSwapsThroughItsMiddle) {
  for (const std::size_t count : {2U, 3U, 4U, 6U, 8U}) {
    const config::Experiment experiment = circleOf(count, 3.0);
    ShieldedFlight flight(experiment, straight);
    flight.takeOff();
    sendAcross(flight, experiment);
    flight.run(60.0);
    EXPECT_GT(flight.closestM(), 0.0) << count;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(flight.isNear(i, -experiment.vehicles[i].start->position_m)) << count << " " << i;
    }
  }
}

TEST(ShieldedFlight, ALoneVehicleFliesAsWithoutIt) {
  const auto commandsWith = [](bool on) {
    config::Experiment experiment = circleOf(1, 3.0);
    experiment.shield.on = on;
    ShieldedFlight flight(experiment, straight);
    flight.takeOff();
    flight.goTo(0, {-3.0, 1.0});
    flight.run(8.0);
    return flight.commands[0];
  };
  const auto with = commandsWith(true);
  const auto without = commandsWith(false);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].mode, without[i].mode) << i;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(with[i].velocity[axis], without[i].velocity[axis]) << i;
      EXPECT_EQ(with[i].position[axis], without[i].position[axis]) << i;
    }
    EXPECT_EQ(with[i].heading, without[i].heading) << i;
    EXPECT_EQ(with[i].valid_for, without[i].valid_for) << i;
  }
}

TEST(ShieldedFlight, KeepsOffObstaclesAndNoFlyZonesThatThePolicyDoesNotKnow) {
  config::Experiment experiment = circleOf(2, 3.0);
  experiment.obstacles = {{"box", {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}}};
  experiment.no_fly_zones = {{"stage", {{-6.0, 3.0}, {6.0, 3.0}, {6.0, 6.0}, {-6.0, 6.0}}}};
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  sendAcross(flight, experiment);
  flight.run(5.0);
  flight.goTo(0, {0.0, 5.0});
  flight.run(10.0);
  EXPECT_GT(flight.closestStaticM(), 0.0);
  EXPECT_GT(flight.interventions(0), 0);
}

TEST(ShieldedFlight, AHeldVehicleIsAnObstacleForTheOthers) {
  const config::Experiment experiment = circleOf(4, 3.0);
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  sendAcross(flight, experiment);
  flight.run(2.0);
  flight.order(core::SafetyOrderKind::kHold, "hex1");
  flight.run(30.0);
  EXPECT_GT(flight.closestM(), 0.0);
  flight.order(core::SafetyOrderKind::kResume, "hex1");
  flight.run(20.0);
  EXPECT_GT(flight.closestM(), 0.0);
  EXPECT_TRUE(flight.isNear(0, -experiment.vehicles[0].start->position_m));
}

TEST(ShieldedFlight, ARingOfParkedVehiclesOpensForWhoseGoalIsInItsMiddle) {
  config::Experiment experiment = circleOf(6, 1.15);
  config::Vehicle last = experiment.vehicles.front();
  last.name = "hex7";
  last.start = config::Start{{4.0, 0.3}, 3.1};
  experiment.vehicles.push_back(last);
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  for (std::size_t i = 0; i < 6; ++i) {
    flight.goTo(i, experiment.vehicles[i].start->position_m);
  }
  flight.goTo(6, kMiddle);
  flight.run(60.0);
  EXPECT_TRUE(flight.isNear(6, kMiddle)) << flight.place(6).transpose();
  EXPECT_GT(flight.closestM(), 0.0);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(flight.isNear(i, experiment.vehicles[i].start->position_m)) << "it returns " << i;
  }
}

// Two fly at each other, one of them 1.2 m higher.
config::Experiment twoStoreys() {
  config::Experiment experiment = circleOf(2, 3.0);
  experiment.vehicles[1].height_m = 2.2;
  return experiment;
}

TEST(ShieldedFlight, WhoIsFarEnoughAboveFliesOver) {
  config::Experiment experiment = twoStoreys();
  experiment.shield.height_separation_m = 0.8;
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  flight.run(3.0);
  sendAcross(flight, experiment);
  flight.run(15.0);
  EXPECT_LT(flight.closestInPlanM(), -0.5) << "one above the other";
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(flight.interventions(i), 0) << i;
    EXPECT_TRUE(flight.isNear(i, -experiment.vehicles[i].start->position_m)) << i;
  }
}

TEST(ShieldedFlight, InTheDownwashNobodyFliesUnlessTheExperimentSaysSo) {
  config::Experiment experiment = twoStoreys();
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  flight.run(3.0);
  sendAcross(flight, experiment);
  flight.run(25.0);
  EXPECT_GT(flight.closestInPlanM(), 0.0);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(flight.isNear(i, -experiment.vehicles[i].start->position_m)) << i;
  }
}

TEST(ShieldedFlight, NobodyTouchesAnybodyWhenEveryFifthMessageIsLost) {
  const config::Experiment experiment = circleOf(6, 2.5);
  ShieldedFlight flight(experiment, chasers, 0.2);
  flight.takeOff();
  sendFarAway(flight, 6);
  flight.run(15.0);
  EXPECT_GT(flight.closestM(), 0.0);
  EXPECT_LT(flight.closestM(), 0.4) << "they did try";
}

TEST(ShieldedFlight, AnUnshieldedVehicleGetsTheWholeGap) {
  config::Experiment experiment = circleOf(4, 3.0);
  experiment.vehicles[0].shielded = false;
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  sendAcross(flight, experiment);
  flight.run(30.0);
  EXPECT_GT(flight.closestM(), 0.0);
}

TEST(ShieldedFlight, ForgedCommandsAreCountedAndChangeNothing) {
  const config::Experiment experiment = circleOf(2, 3.0);
  ShieldedFlight flight(experiment, straight);
  flight.takeOff();
  sendAcross(flight, experiment);
  flight.run(1.0);
  const int before = flight.statuses[0].back().rejected_messages;
  core::Command forged;
  forged.vehicle = "hex2";
  forged.mode = core::CommandMode::kVelocity;
  forged.velocity_world_mps = {-2.0, 0.0, 0.0};
  forged.valid_for_s = 0.3;
  forged.utime = flight.now() + 5'000'000;  // later than any
  bus::publish(flight.lab(), "COMMAND_hex2", bus::toMessage(forged));
  forged.utime = 1;  // older than the one before
  bus::publish(flight.lab(), "COMMAND_hex2", bus::toMessage(forged));
  forged.vehicle = "hex1";  // not the channel's
  bus::publish(flight.lab(), "COMMAND_hex2", bus::toMessage(forged));
  flight.run(0.3);
  EXPECT_EQ(flight.statuses[0].back().rejected_messages, before + 3);
  flight.run(20.0);
  EXPECT_GT(flight.closestM(), 0.0);
  EXPECT_TRUE(flight.isNear(0, -experiment.vehicles[0].start->position_m));
}

}  // namespace
}  // namespace roundabout::planner
