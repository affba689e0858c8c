#include "sim/dynamics/ground_robot/ground_robot.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "common/core/vehicle_state.h"
#include "sim/sensors/odometer.h"
#include "sim/world.h"

namespace roundabout::sim {
namespace {

constexpr double kStepS = 0.005;

class GroundRobotTest : public testing::Test {
 protected:
  static Setpoint velocity(double x_mps, double y_mps) {
    Setpoint setpoint;
    setpoint.guidance = Guidance::kVelocity;
    setpoint.velocity_world_mps = {x_mps, y_mps};
    return setpoint;
  }

  void drive(const Setpoint& setpoint, double seconds) {
    for (int i = 0; i < std::lround(seconds / kStepS); ++i) {
      robot_.step(setpoint, Eigen::Vector2d::Zero(), kStepS);
    }
  }
  double heading() const { return core::headingOf(robot_.body().orientation); }
  Eigen::Vector2d place() const { return robot_.body().position_world_m.head<2>(); }
  double speed() const { return robot_.body().velocity_world_mps.norm(); }

  static config::GroundRobotModel model() {
    config::GroundRobotModel model;
    model.max_wheel_speed_mps = 1.5;
    model.max_wheel_acceleration_mps2 = 2.0;
    return model;
  }

  static config::Vehicle rover() {
    config::Vehicle vehicle;
    vehicle.top_speed_mps = 1.6;
    return vehicle;
  }

  const config::GroundRobotModel model_ = model();
  GroundRobot robot_{rover(), model_, {}};
};

TEST_F(GroundRobotTest, KeepsTheSpeedOfASmallTurnAndTurnsToItsCourse) {
  drive(velocity(1.0, 0.0), 3.0);
  const double course_rad = std::numbers::pi / 6.0;  // the policies' largest
  double slowest_mps = 1.0;
  for (int i = 0; i < 200; ++i) {
    drive(velocity(std::cos(course_rad), std::sin(course_rad)), kStepS);
    slowest_mps = std::min(slowest_mps, speed());
  }
  EXPECT_GT(slowest_mps, 0.8);
  EXPECT_NEAR(heading(), course_rad, 0.02);
  EXPECT_NEAR(speed(), 1.0, 0.01);
}

TEST_F(GroundRobotTest, TurnsOnTheSpotForWhatIsBehindIt) {
  drive(velocity(-1.0, 0.1), 0.5);
  EXPECT_LT(place().norm(), 0.02);
  EXPECT_GT(heading(), 0.5);
  drive(velocity(-1.0, 0.1), 4.0);
  EXPECT_LT(place().x(), -1.0);
}

TEST_F(GroundRobotTest, NeverLeavesTheLimitsOfItsWheelsWhateverIsCommanded) {
  core::RandomStream random(1, "wheels");
  WheelSpeeds before = robot_.wheels();
  Setpoint setpoint;
  for (int i = 0; i < 20000; ++i) {
    if (i % 20 == 0) {
      setpoint = velocity(random.normal(3.0), random.normal(3.0));
      setpoint.guidance = random.chance(0.5) ? Guidance::kVelocity : Guidance::kPosition;
      setpoint.position_world_m = random.normal3(2.0);
    }
    robot_.step(setpoint, Eigen::Vector2d::Zero(), kStepS);
    const WheelSpeeds now = robot_.wheels();
    ASSERT_LE(std::abs(now.left_mps), 1.5 + 1e-9);
    ASSERT_LE(std::abs(now.right_mps), 1.5 + 1e-9);
    ASSERT_LE(std::abs(now.left_mps - before.left_mps), 2.0 * kStepS + 1e-9);
    ASSERT_LE(std::abs(now.right_mps - before.right_mps), 2.0 * kStepS + 1e-9);
    before = now;
  }
}

TEST_F(GroundRobotTest, DrivesBackwardsOnlyTheLastBitToAPosition) {
  Setpoint setpoint;
  setpoint.guidance = Guidance::kPosition;
  setpoint.position_world_m = {-0.2, 0.0, 0.0};
  drive(setpoint, 5.0);
  EXPECT_NEAR(place().x(), -0.2, 0.01);
  EXPECT_LT(std::abs(heading()), 0.1) << "turned round for 20 cm";
  setpoint.position_world_m = {-2.2, 0.0, 0.0};
  setpoint.heading_world_rad = std::numbers::pi;
  drive(setpoint, 1.0);
  EXPECT_GT(std::abs(heading()), 1.0) << "drove two metres backwards";
}

// ---- odometry

class OdometerTest : public GroundRobotTest {
 protected:
  // A course with turns.
  Setpoint course(double time_s) const {
    return velocity(std::cos(0.5 * time_s), std::sin(0.5 * time_s));
  }
};

TEST_F(OdometerTest, WithoutErrorsKnowsWhereTheRobotIs) {
  config::GroundRobotModel exact = model_;
  exact.odometry.wheel_error = 0.0;
  exact.odometry.slip_m = 0.0;
  Odometer odometer(exact, "rover", 1, robot_.body());
  for (int i = 0; i < 4000; ++i) {
    robot_.step(course(i * kStepS), Eigen::Vector2d::Zero(), kStepS);
    odometer.step(robot_.wheels(), kStepS);
  }
  const core::Odometry reading = odometer.reading(7);
  EXPECT_EQ(reading.utime, 7);
  EXPECT_LT((reading.position_world_m - place()).norm(), 1e-9);
  EXPECT_NEAR(std::remainder(reading.heading_world_rad - heading(), 2.0 * std::numbers::pi), 0.0,
              1e-9);
}

TEST_F(OdometerTest, DriftsAsItsErrorsSay) {
  constexpr int kRobots = 400;
  constexpr int kSteps = 2000;  // 10 m straight at 1 m/s
  double squares = 0.0;
  for (int seed = 0; seed < kRobots; ++seed) {
    Odometer odometer(model_, "rover", static_cast<std::uint64_t>(seed), robot_.body());
    for (int i = 0; i < kSteps; ++i) {
      odometer.step({1.0, 1.0}, kStepS);
    }
    squares += std::pow(odometer.reading(0).heading_world_rad, 2.0);
  }
  // Two wheels' constant errors over 10 m, and their slips: independent.
  const config::OdometryModel& errors = model_.odometry;
  const double constant = 2.0 * std::pow(10.0 * errors.wheel_error, 2.0);
  const double random = 2.0 * 10.0 * std::pow(errors.slip_m, 2.0);
  const double expected_rad = std::sqrt(constant + random) / model_.wheel_base_m;
  EXPECT_NEAR(std::sqrt(squares / kRobots), expected_rad, 0.1 * expected_rad);
}

TEST(Odometers, ARobotDrivesToWhereItBelievesThatItsGoalIs) {
  config::Experiment experiment;
  experiment.file = "test";
  config::Vehicle rover;
  rover.name = "rover";
  rover.model = "ground_robot";
  rover.start = config::Start{{-3.0, 0.0}, 0.0};
  rover.localised_by = "odometry";
  experiment.vehicles = {rover};
  experiment.sim.ground_robot.odometry.wheel_error = 0.06;
  World world(experiment, core::kMicrosPerSecond);
  Odometers odometers(experiment, world.bodies());
  core::Command command;
  command.vehicle = "rover";
  command.mode = core::CommandMode::kPosition;
  command.position_world_m = {2.0, 1.0, 0.0};
  command.valid_for_s = 0.3;
  while (world.now() < 25 * core::kMicrosPerSecond) {
    if (world.now() % 100'000 == 0) {
      command.utime = command.state_utime = world.now();
      ASSERT_EQ(world.accept(0, odometers.asDriven(0, command, world.bodies())), nullptr);
    }
    world.step();
    odometers.step(world.wheels(), experiment.sim.step_s);
  }
  const Eigen::Vector2d goal_m = command.position_world_m.head<2>();
  const auto off = [&](const BodyState& body) -> double {
    return (body.position_world_m.head<2>() - goal_m).norm();
  };
  EXPECT_LT(off(odometers.believed(world.bodies())[0]), 0.05);
  EXPECT_GT(off(world.bodies()[0]), 0.1);
  // Who is localised by something else gets its commands as they are.
  experiment.vehicles[0].localised_by = "mocap";
  const Odometers unused(experiment, world.bodies());
  EXPECT_EQ(unused.asDriven(0, command, world.bodies()).position_world_m, command.position_world_m);
}

}  // namespace
}  // namespace roundabout::sim
