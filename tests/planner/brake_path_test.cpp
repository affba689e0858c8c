// What the shield's theorem assumes: a vehicle that gets no further command stays within half of
// the margin of its predicted brake path. The oracle is the simulator's multirotor: autopilot,
// attitude loop, limits on tilt, acceleration and jerk, drag.

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "planner/shield/convex_gap.h"
#include "planner/shield/observer.h"
#include "sim/world.h"

namespace roundabout::planner::shield {
namespace {

using Eigen::Vector2d;

constexpr core::Utime kPeriod = 100'000;
constexpr double kValid_s = 0.3;
constexpr double kHeight_m = 1.0;

enum class End { kToldToBrake, kToldNothing };

/// One vehicle, told something else now and then, and then nothing any more.
class Flight {
 public:
  Flight(double slower, std::uint64_t seed, double top_speed_mps)
      : experiment_(describe(slower)),
        world_(experiment_, core::kMicrosPerSecond),
        observer_(bounds()),
        random_(seed, "flight"),
        top_speed_mps_(top_speed_mps) {}

  static MotionBounds bounds() {
    const config::MotionBounds assumed;
    MotionBounds result;
    result.delay_s = assumed.delay_s;
    result.lag_s = assumed.lag_s;
    result.inner_lag_s = assumed.inner_lag_s;
    result.reserve = 1.5;
    result.max_jerk_mps3 = 30.0;
    result.max_acceleration_mps2 = config::Vehicle().max_acceleration_mps2;
    return result;
  }

  /// How far from its predicted brake path it gets. m
  double run(int decisions, End end) {
    takeOff();
    for (int k = 0; k < decisions; ++k) {
      decide();
      advance(kPeriod);
    }
    return coast(end);
  }

 private:
  static config::Experiment describe(double slower) {
    config::Experiment experiment;
    experiment.vehicles.resize(1);
    experiment.vehicles[0].name = "multirotor";
    experiment.vehicles[0].top_speed_mps = 10.0;
    experiment.vehicles[0].start = config::Start{};
    config::MultirotorModel& model = experiment.sim.multirotor;
    model.velocity_gain_per_s /= slower;
    model.attitude_time_constant_s *= slower;
    model.command_delay_s = slower * bounds().delay_s;
    return experiment;
  }

  core::Command command(const Vector2d& velocity_mps) const {
    core::Command command;
    command.mode = core::CommandMode::kVelocity;
    command.utime = world_.now();
    command.valid_for_s = kValid_s;
    command.velocity_world_mps << velocity_mps, 0.0;
    command.position_world_m.z() = kHeight_m;
    return command;
  }

  void takeOff() {
    for (int k = 0; k < 60; ++k) {
      core::Command up = command(Vector2d::Zero());
      up.mode = core::CommandMode::kPosition;
      world_.accept(0, up);
      advance(kPeriod);
    }
  }

  void advance(core::Utime duration) {
    for (const core::Utime end = world_.now() + duration; world_.now() < end;) {
      world_.step();
    }
  }

  Vector2d position() const { return world_.bodies()[0].position_world_m.head<2>(); }

  void observe() {
    observer_.onState(core::toSeconds(world_.now()), position(),
                      world_.bodies()[0].velocity_world_mps.head<2>(), 0.0);
  }

  void decide() {
    observe();
    if (random_.chance(0.3)) {
      const double angle = random_.uniform(-3.2, 3.2);
      wish_mps_ =
          top_speed_mps_ * random_.uniform(0.0, 1.0) * Vector2d(std::cos(angle), std::sin(angle));
    }
    world_.accept(0, command(wish_mps_));
    observer_.onCommand(core::toSeconds(world_.now()), wish_mps_, kValid_s);
  }

  double coast(End end) {
    observe();
    const Motion motion = observer_.motion(core::toSeconds(world_.now()));
    const bool told = end == End::kToldToBrake;
    const SentCommand brake{Vector2d::Zero(), 0.0, kValid_s};
    std::vector<Vector2d> hull;
    Path path;
    for (const Pace pace : {Pace::kAssumed, Pace::kSlowest}) {
      predict(motion, bounds(), pace, Arrival::kAll, told ? &brake : nullptr, path);
      hull.insert(hull.end(), path.points().begin(), path.points().end());
    }
    double worst_m = 0.0;
    for (int k = 0; k < 40; ++k) {
      if (told) {
        world_.accept(0, command(Vector2d::Zero()));
      }
      for (const core::Utime until = world_.now() + kPeriod; world_.now() < until;) {
        world_.step();
        const std::array<Vector2d, 1> here{position()};
        worst_m = std::max(worst_m, gapBetween(hull, here).distance_m);
      }
    }
    return worst_m;
  }

  config::Experiment experiment_;
  sim::World world_;
  Observer observer_;
  core::RandomStream random_;
  double top_speed_mps_;
  Vector2d wish_mps_ = Vector2d::Zero();
};

double worstOf(double slower, double top_speed_mps, End end) {
  constexpr int kFlights = 200;
  double worst_m = 0.0;
  core::RandomStream random(7, "lengths");
  for (int k = 0; k < kFlights; ++k) {
    const int decisions = 1 + static_cast<int>(random.uniform(0.0, 20.0));
    Flight flight(slower, static_cast<std::uint64_t>(k), top_speed_mps);
    worst_m = std::max(worst_m, flight.run(decisions, end));
  }
  return worst_m;
}

TEST(BrakePath, HoldsWhateverPartOfTheReserveIsUsedUp) {
  for (const double slower : {1.0, 1.25, 1.5}) {
    EXPECT_LE(worstOf(slower, 1.0, End::kToldToBrake), 0.02) << slower;
  }
}

// The autopilot brakes by itself, and then keeps the place where it became slow: beside the path,
// if it was turning round there.
TEST(BrakePath, HoldsNearlyWhenCommandsExpire) {
  for (const double slower : {1.0, 1.25, 1.5}) {
    EXPECT_LE(worstOf(slower, 1.0, End::kToldNothing), 0.04) << slower;
  }
}

TEST(BrakePath, DoesNotHoldBeyondTheReserve) {
  EXPECT_GE(worstOf(2.0, 1.0, End::kToldToBrake), 0.1);
}

}  // namespace
}  // namespace roundabout::planner::shield
