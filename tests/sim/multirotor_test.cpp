#include "sim/dynamics/multirotor/multirotor.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "sim/step_response.h"
#include "tests/sim/flight.h"
#include "tests/support/allocation_count.h"

namespace roundabout::sim {
namespace {

constexpr double kStepS = 0.005;
const config::MultirotorModel kModel;

// The vehicle without its autopilot.
class MultirotorTest : public ::testing::Test {
 protected:
  Multirotor vehicle_{kModel, config::Start{}};
  Setpoint setpoint_;

  void run(double seconds) {
    for (double left = seconds; left > 0.5 * kStepS; left -= kStepS) {
      vehicle_.step(setpoint_, Eigen::Vector2d::Zero(), kStepS);
    }
  }
  void hover(double height_m) {
    setpoint_.guidance = Guidance::kPosition;
    setpoint_.position_world_m = {0.0, 0.0, height_m};
    run(10.0 + height_m / 0.6);
  }
};

struct Extremes {
  double tilt_rad = 0.0;
  double acceleration_mps2 = 0.0;  // horizontal, without drag, which is not the controllers' doing
  double jerk_mps3 = 0.0;
  double climb_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

Extremes flyRandomly(Multirotor& vehicle, double height_m, double height_spread_m) {
  core::RandomStream random(5, "limits");
  Extremes most;
  Setpoint setpoint;
  Eigen::Vector3d last_velocity = vehicle.body().velocity_world_mps;
  Eigen::Vector3d last_acceleration = Eigen::Vector3d::Zero();
  double last_heading_rad = core::headingOf(vehicle.body().orientation);
  for (int i = 0; i < 50000; ++i) {
    if (i % 50 == 0) {
      setpoint.guidance = random.chance(0.5) ? Guidance::kVelocity : Guidance::kPosition;
      setpoint.velocity_world_mps = random.normal3(2.0).head<2>();
      setpoint.position_world_m = random.normal3(3.0);
      setpoint.position_world_m.z() = height_m + random.normal(height_spread_m);
      setpoint.heading_world_rad = random.uniform(-3.0, 3.0);
    }
    vehicle.step(setpoint, Eigen::Vector2d::Zero(), kStepS);
    const BodyState& body = vehicle.body();
    const Eigen::Vector3d acceleration =
        (body.velocity_world_mps - last_velocity) / kStepS + kModel.drag_per_s * last_velocity;
    const double heading_rad = core::headingOf(body.orientation);
    const double turn_rad = std::remainder(heading_rad - last_heading_rad, 2.0 * std::numbers::pi);
    most.tilt_rad = std::max(most.tilt_rad, vehicle.tiltRad());
    most.acceleration_mps2 = std::max(most.acceleration_mps2, acceleration.head<2>().norm());
    most.jerk_mps3 = std::max(most.jerk_mps3, (acceleration - last_acceleration).norm() / kStepS);
    most.climb_mps = std::max(most.climb_mps, body.velocity_world_mps.z());
    if (vehicle.tiltRad() < 0.01) {  // else the heading of the leaning body is not the yaw
      most.yaw_rate_radps = std::max(most.yaw_rate_radps, std::abs(turn_rad) / kStepS);
    }
    last_velocity = body.velocity_world_mps;
    last_acceleration = acceleration;
    last_heading_rad = heading_rad;
  }
  return most;
}

TEST_F(MultirotorTest, ReachesButDoesNotExceedItsLimitsInLevelFlight) {
  hover(10.0);
  const Extremes most = flyRandomly(vehicle_, 10.0, 0.0);
  EXPECT_LE(most.tilt_rad, kModel.max_tilt_rad);
  EXPECT_LE(most.acceleration_mps2, 1.001 * kModel.max_acceleration_mps2);
  EXPECT_LE(most.jerk_mps3, 1.001 * kModel.max_jerk_mps3);
  EXPECT_LE(most.yaw_rate_radps, 1.02 * kModel.max_yaw_rate_radps);
  EXPECT_GT(most.acceleration_mps2, 0.95 * kModel.max_acceleration_mps2);
  EXPECT_GT(most.jerk_mps3, 0.5 * kModel.max_jerk_mps3);
  EXPECT_GT(most.yaw_rate_radps, 0.95 * kModel.max_yaw_rate_radps);
}

// Pulling up while it leans adds to the horizontal acceleration until the tilt has followed.
TEST_F(MultirotorTest, ExceedsItsLimitsByAQuarterAtMostWhenItClimbsToo) {
  hover(50.0);
  const Extremes most = flyRandomly(vehicle_, 50.0, 3.0);
  EXPECT_LE(most.tilt_rad, kModel.max_tilt_rad);
  EXPECT_LE(most.acceleration_mps2, 1.25 * kModel.max_acceleration_mps2);
  EXPECT_LE(most.jerk_mps3, 1.25 * kModel.max_jerk_mps3);
  EXPECT_LE(most.climb_mps, 1.02 * kModel.max_climb_mps);
}

TEST_F(MultirotorTest, HoversAtOneGravityWithoutTilt) {
  hover(1.0);
  EXPECT_NEAR(vehicle_.body().position_world_m.z(), 1.0, 1e-4);
  EXPECT_LT(vehicle_.body().velocity_world_mps.norm(), 1e-4);
  EXPECT_LT(vehicle_.tiltRad(), 1e-4);
}

TEST_F(MultirotorTest, LeansTheWayItAccelerates) {
  hover(5.0);
  setpoint_.guidance = Guidance::kVelocity;
  setpoint_.heading_world_rad = 1.0;
  setpoint_.velocity_world_mps = {-1.0, 1.0};
  run(0.3);
  const Eigen::Vector3d up = vehicle_.body().orientation * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::atan2(up.y(), up.x()), 0.75 * std::numbers::pi, 1e-6);
  EXPECT_NEAR(std::acos(up.z()), vehicle_.tiltRad(), 1e-9);
}

TEST_F(MultirotorTest, FollowsAConstantPushOnlyAsFarAsItsGainsSay) {
  hover(5.0);
  for (int i = 0; i < 4000; ++i) {
    vehicle_.step(setpoint_, {0.36, 0.0}, kStepS);
  }
  // No integral term: push = (velocity gain + drag) * position gain * offset.
  EXPECT_NEAR(vehicle_.body().position_world_m.x(), 0.36 / (3.1 * 1.2), 1e-4);
}

TEST_F(MultirotorTest, FallsAsAStoneInAirWithoutItsMotors) {
  hover(20.0);
  const double begin_m = vehicle_.body().position_world_m.z();
  setpoint_ = Setpoint();
  run(1.0);
  // Linear drag d: distance = (g / d) (t - (1 - exp(-d t)) / d).
  const double drag = kModel.drag_per_s;
  const double distance_m = kGravityMps2 / drag * (1.0 - (1.0 - std::exp(-drag)) / drag);
  EXPECT_NEAR(begin_m - vehicle_.body().position_world_m.z(), distance_m, 0.005);
}

TEST_F(MultirotorTest, GainsNoEnergyWithoutItsMotors) {
  hover(10.0);
  setpoint_.guidance = Guidance::kVelocity;
  setpoint_.velocity_world_mps = {1.5, 0.0};
  run(3.0);
  setpoint_ = Setpoint();
  double last_energy = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 600; ++i) {
    vehicle_.step(setpoint_, Eigen::Vector2d::Zero(), kStepS);
    const BodyState& body = vehicle_.body();
    const double energy =
        kGravityMps2 * body.position_world_m.z() + 0.5 * body.velocity_world_mps.squaredNorm();
    ASSERT_LT(energy, last_energy + 1e-9);
    last_energy = energy;
  }
  EXPECT_TRUE(vehicle_.body().on_floor);
  EXPECT_EQ(vehicle_.body().position_world_m.z(), 0.0);
  EXPECT_EQ(vehicle_.body().velocity_world_mps.norm(), 0.0);
}

TEST_F(MultirotorTest, StepAllocatesNothing) {
  hover(1.0);
  setpoint_.guidance = Guidance::kVelocity;
  setpoint_.velocity_world_mps = {1.0, 1.0};
  const std::size_t before = test::allocationCount();
  run(1.0);
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(MultirotorFlight, ClimbsAndLandsNoFasterThanItsLimits) {
  Flight flight("multirotor");
  double climb_mps = 0.0;
  double descend_mps = 0.0;
  flight.watch([&] {
    climb_mps = std::max(climb_mps, flight.body().velocity_world_mps.z());
    descend_mps = std::max(descend_mps, -flight.body().velocity_world_mps.z());
  });
  flight.fly(flight.position(0.0, 0.0, 3.0), 10.0);
  flight.fly(flight.of(core::CommandMode::kLand), 12.0);
  EXPECT_FALSE(flight.body().motors_on);
  EXPECT_EQ(flight.height(), 0.0);
  EXPECT_NEAR(climb_mps, kModel.max_climb_mps, 0.02);
  EXPECT_NEAR(descend_mps, kModel.max_descend_mps, 0.02);
}

TEST(MultirotorFlight, StaysOnTheFloorUntilToldToAPositionAboveIt) {
  Flight flight("multirotor");
  flight.fly(flight.velocity(1.0, 0.0), 1.0);
  flight.fly(flight.of(core::CommandMode::kHold), 1.0);
  flight.fly(flight.position(1.0, 1.0, 0.05), 1.0);
  EXPECT_FALSE(flight.body().motors_on);
  EXPECT_EQ(flight.body().position_world_m.norm(), 0.0);
  flight.fly(flight.position(0.0, 0.0, 1.0), 0.1);
  EXPECT_TRUE(flight.body().motors_on);
}

TEST(MultirotorFlight, LandsAfterABrakeAboveThePlaceWhereItStopped) {
  Flight flight("multirotor");
  flight.takeOff();
  flight.fly(flight.velocity(1.0, 0.0), 3.0);
  double stopped_m = 0.0;
  flight.watch([&] {
    if (flight.height() > 0.9) {
      stopped_m = flight.body().position_world_m.x();
    }
  });
  flight.fly(flight.of(core::CommandMode::kLand), 8.0);
  EXPECT_FALSE(flight.body().motors_on);
  EXPECT_NEAR(flight.body().position_world_m.x(), stopped_m, 0.1);
}

// The figures that docs/multirotor.md states.
TEST(MultirotorStepResponse, VelocityLagsByAThirdToHalfASecond) {
  const StepFigures figures = figuresOf(stepResponse({}, StepKind::kVelocity, 1.0, 5.0), 1.0);
  EXPECT_GT(figures.lag_s, 0.3);
  EXPECT_LT(figures.lag_s, 0.5);
  EXPECT_LT(figures.overshoot, 0.05);
  EXPECT_NEAR(figures.steady, 1.0, 0.001);
}

TEST(MultirotorStepResponse, PositionDoesNotOvershoot) {
  const StepFigures figures = figuresOf(stepResponse({}, StepKind::kPosition, 2.0, 6.0), 2.0);
  EXPECT_LT(figures.overshoot, 0.01);
  EXPECT_NEAR(figures.steady, 1.0, 0.001);
}

TEST(MultirotorStepResponse, CommandDelayDelaysTheWholeResponse) {
  config::Sim late;
  late.multirotor.command_delay_s += 0.1;
  const double lag_s = figuresOf(stepResponse({}, StepKind::kVelocity, 1.0, 3.0), 1.0).lag_s;
  const double late_lag_s = figuresOf(stepResponse(late, StepKind::kVelocity, 1.0, 3.0), 1.0).lag_s;
  EXPECT_NEAR(late_lag_s - lag_s, 0.1, 1e-9);
}

TEST(MultirotorStepResponse, StopsLaterTheFasterItWas) {
  const double slow_m = stoppingDistanceM({}, 0.5);
  const double fast_m = stoppingDistanceM({}, 1.0);
  // Mean lag 1/3 s, delay 0.02 s, and what the limits add.
  EXPECT_GT(slow_m, 0.5 * 0.34);
  EXPECT_GT(fast_m, 2.0 * slow_m - 0.01);
  EXPECT_LT(fast_m, 0.5);
}

TEST(MultirotorStepResponse, HeadingTurnsNoFasterThanItsLimit) {
  const auto response = stepResponse({}, StepKind::kHeading, 1.5, 4.0);
  for (std::size_t i = 1; i < response.size(); ++i) {
    ASSERT_LE((response[i].response - response[i - 1].response) / kStepS,
              1.001 * kModel.max_yaw_rate_radps);
  }
  EXPECT_NEAR(figuresOf(response, 1.5).steady, 1.0, 0.001);
}

}  // namespace
}  // namespace roundabout::sim
