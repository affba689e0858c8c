// What every vehicle model keeps to, whatever it is told.

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/error.h"
#include "common/core/random.h"
#include "sim/dynamics/table.h"
#include "tests/sim/flight.h"

namespace roundabout::sim {
namespace {

using core::CommandMode;

class DynamicsContract : public testing::TestWithParam<DynamicsEntry> {
 protected:
  Flight flight_{std::string(GetParam().name)};
  core::RandomStream random_{7, "contract"};

  // Any finite numbers, sensible or not.
  core::Command randomCommand() {
    core::Command command =
        flight_.of(random_.chance(0.7) ? CommandMode::kVelocity : CommandMode::kPosition);
    command.velocity_world_mps = random_.normal3(random_.chance(0.1) ? 1e6 : 2.0);
    command.position_world_m = random_.normal3(random_.chance(0.1) ? 1e6 : 3.0);
    command.heading_world_rad = random_.normal(20.0);
    command.heading_rate_radps = random_.normal(5.0);
    return command;
  }

  void expectAtRest() {
    EXPECT_LT(flight_.speed(), 0.01);
    const Eigen::Vector3d before = flight_.body().position_world_m;
    flight_.glide(0.1);
    EXPECT_LT((flight_.body().position_world_m - before).norm(), 0.001);
  }
};

TEST_P(DynamicsContract, StartsAtRestWithTheMotorsOff) {
  EXPECT_FALSE(flight_.body().motors_on);
  flight_.glide(2.0);
  EXPECT_FALSE(flight_.body().motors_on);
  EXPECT_TRUE(flight_.body().on_floor);
  expectAtRest();
}

TEST_P(DynamicsContract, StaysFiniteAndWithinItsTopSpeedWhateverIsCommanded) {
  flight_.takeOff();
  // The velocity loop overshoots a little.
  const double most_mps = 1.1 * flight_.vehicle().top_speed_mps;
  double fastest_mps = 0.0;
  flight_.watch([&] {
    ASSERT_TRUE(flight_.body().position_world_m.allFinite());
    ASSERT_TRUE(flight_.body().velocity_world_mps.allFinite());
    ASSERT_NEAR(flight_.body().orientation.norm(), 1.0, 1e-9);
    ASSERT_GE(flight_.height(), 0.0);
    fastest_mps = std::max(fastest_mps, flight_.body().velocity_world_mps.head<2>().norm());
  });
  for (int i = 0; i < 300; ++i) {
    flight_.fly(randomCommand(), random_.uniform(0.1, 1.0));
  }
  EXPECT_LT(fastest_mps, most_mps);
  EXPECT_GT(fastest_mps, 0.5 * most_mps);
}

TEST_P(DynamicsContract, FliesTheCommandedVelocityInTheEnd) {
  flight_.takeOff();
  flight_.fly(flight_.velocity(0.6, -0.8), 4.0);
  EXPECT_THAT(flight_.body().velocity_world_mps.x(), testing::DoubleNear(0.6, 0.01));
  EXPECT_THAT(flight_.body().velocity_world_mps.y(), testing::DoubleNear(-0.8, 0.01));
  EXPECT_NEAR(flight_.height(), flight_.vehicle().height_m, 0.02);
}

TEST_P(DynamicsContract, FliesToAPositionAndTurnsToItsHeading) {
  flight_.takeOff();
  core::Command command = flight_.position(1.0, -2.0, flight_.vehicle().height_m);
  command.heading_world_rad = 2.0;
  flight_.fly(command, 10.0);
  EXPECT_LT((flight_.body().position_world_m - command.position_world_m).norm(), 0.01);
  EXPECT_NEAR(core::headingOf(flight_.body().orientation), 2.0, 0.01);
}

TEST_P(DynamicsContract, HoldStopsWithinTheBrakingDistanceAndStays) {
  for (const double speed_mps : {0.5, 1.0, 2.0}) {
    Flight flight{std::string(GetParam().name)};
    flight.takeOff();
    flight.fly(flight.velocity(speed_mps, 0.0), 5.0);
    const double begin_m = flight.body().position_world_m.x();
    double farthest_m = begin_m;
    flight.watch([&] { farthest_m = std::max(farthest_m, flight.body().position_world_m.x()); });
    flight.fly(flight.of(CommandMode::kHold), 5.0);
    // Delay, lag and the controller's soft end; then v^2 / 2a with what it says it can brake with.
    const double lag_s = 0.5;
    const double bound_m =
        speed_mps * lag_s + speed_mps * speed_mps / (2.0 * flight.vehicle().max_acceleration_mps2);
    EXPECT_LT(farthest_m - begin_m, bound_m) << "from " << speed_mps << " m/s";
    EXPECT_LT(flight.speed(), 0.01);
    EXPECT_NEAR(flight.height(), flight.vehicle().height_m, 0.05);
  }
}

TEST_P(DynamicsContract, LandsAndStopsTheMotors) {
  flight_.takeOff();
  flight_.fly(flight_.velocity(1.0, 0.0), 2.0);
  flight_.fly(flight_.of(CommandMode::kLand), 8.0);
  EXPECT_FALSE(flight_.body().motors_on);
  EXPECT_TRUE(flight_.body().on_floor);
  expectAtRest();
}

TEST_P(DynamicsContract, FliesAgainAfterLanding) {
  flight_.takeOff();
  flight_.fly(flight_.of(CommandMode::kLand), 8.0);
  flight_.fly(flight_.position(0.5, 0.0, flight_.vehicle().height_m), 8.0);
  EXPECT_TRUE(flight_.body().motors_on);
  EXPECT_NEAR(flight_.body().position_world_m.x(), 0.5, 0.01);
}

TEST_P(DynamicsContract, KillStopsTheMotorsAtOnceAndForGood) {
  flight_.takeOff();
  flight_.fly(flight_.velocity(1.0, 0.0), 2.0);
  flight_.fly(flight_.of(CommandMode::kKill), 0.1);
  EXPECT_FALSE(flight_.body().motors_on);
  flight_.fly(flight_.of(CommandMode::kHold), 2.0);
  EXPECT_FALSE(flight_.body().motors_on);
  EXPECT_TRUE(flight_.body().on_floor);
  expectAtRest();
}

TEST_P(DynamicsContract, IsDisplacedByAPushAndComesToRest) {
  config::Sim sim;
  sim.pushes.push_back({"hex1", 7.0, 0.5, {0.0, 3.0}});
  Flight flight(std::string(GetParam().name), sim);
  flight.takeOff();
  double farthest_m = 0.0;
  flight.watch([&] { farthest_m = std::max(farthest_m, flight.body().position_world_m.y()); });
  flight.fly(flight.of(CommandMode::kHold), 8.0);
  EXPECT_GT(farthest_m, 0.1);
  EXPECT_LT(flight.speed(), 0.01);
}

TEST_P(DynamicsContract, FliesTheSameEveryTime) {
  const auto flown = [] {
    Flight flight{std::string(GetParam().name)};
    core::RandomStream random(3, "same");
    flight.takeOff();
    for (int i = 0; i < 50; ++i) {
      flight.fly(flight.velocity(random.normal(1.0), random.normal(1.0)), 0.3);
    }
    return flight.body().position_world_m;
  };
  EXPECT_EQ(flown(), flown());
}

INSTANTIATE_TEST_SUITE_P(EveryModel, DynamicsContract, testing::ValuesIn(dynamicsTable()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(DynamicsTable, RefusesAnUnknownModelAndNamesTheKnownOnes) {
  config::Vehicle vehicle;
  vehicle.name = "hex1";
  vehicle.model = "submarine";
  try {
    makeDynamics(vehicle, {}, {}, "demo.yaml");
    FAIL() << "made a submarine";
  } catch (const core::StartupError& error) {
    EXPECT_STREQ(error.what(),
                 "demo.yaml: vehicles.hex1.model: expected unicycle or multirotor or ground_robot, "
                 "found "
                 "\"submarine\"");
  }
}

}  // namespace
}  // namespace roundabout::sim
