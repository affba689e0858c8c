// What the shield's theorem assumes: a vehicle that gets no further command stays within half of
// the margin of its predicted brake path. The oracle is the simulator's multirotor: autopilot,
// attitude loop, limits on tilt, acceleration and jerk, drag.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

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
    const MotionBounds assumed = bounds();
    for (const Pace pace : {Pace::kAssumed, Pace::kSlowest}) {
      predict({&motion, &assumed, pace, Arrival::kAll, told ? &brake : nullptr}, path);
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

struct Told {
  Motion motion;
  MotionBounds bounds;
  std::array<SentCommand, 3> commands;
  SentCommand next;
};

Vector2d randomVector(core::RandomStream& random, double most) {
  return {random.uniform(-most, most), random.uniform(-most, most)};
}

// Multirotors of all sorts, one in four something else.
Told randomTold(core::RandomStream& random) {
  Told told;
  told.bounds = Flight::bounds();
  told.bounds.max_acceleration_mps2 = random.uniform(1.0, 4.0);
  told.bounds.max_jerk_mps3 = random.chance(0.5) ? 30.0 : std::numeric_limits<double>::infinity();
  if (random.chance(0.25)) {
    (random.chance(0.5) ? told.bounds.max_turn_rate_radps : told.bounds.inner_lag_s) = 0.0;
  }
  told.motion.position_world_m = randomVector(random, 3.0);
  told.motion.velocity_world_mps = randomVector(random, 1.5);
  told.motion.age_s = random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.3);
  for (Drive& drive : told.motion.drives) {
    drive = {randomVector(random, 3.0), randomVector(random, 3.0)};
  }
  double age_s = random.uniform(0.2, 0.4);
  for (SentCommand& command : told.commands) {
    command = {randomVector(random, 1.5), age_s, kValid_s};
    age_s -= 0.1;
  }
  told.next = {randomVector(random, 1.5), 0.0, kValid_s};
  return told;
}

// Step by step, with the laws of motion alone: where it is after each step of a path.
std::vector<Vector2d> stepByStep(const Told& told, Pace pace, std::size_t steps) {
  const MotionBounds bounds = told.bounds.at(pace);
  Vector2d position = told.motion.position_world_m;
  Vector2d velocity = told.motion.velocity_world_mps;
  Drive drive = told.motion.drives[static_cast<std::size_t>(pace)];
  const auto commandAt = [&](double time_s) {
    Vector2d in_force = told.commands.front().velocity_world_mps;
    for (const SentCommand& each :
         {told.commands[0], told.commands[1], told.commands[2], told.next}) {
      if (time_s + each.age_s >= bounds.delay_s) {
        in_force = time_s + each.age_s < each.valid_for_s ? each.velocity_world_mps
                                                          : Vector2d(Vector2d::Zero());
      }
    }
    return in_force;
  };
  const double step_s = 0.5 * Path::kStep_s;
  const auto advance = [&](double from_s, double part_s) {
    const double share = part_s / step_s * (1.0 - std::exp(-step_s / bounds.inner_lag_s));
    follow(wantedAcceleration(commandAt(from_s + 0.5 * part_s) - velocity, bounds), bounds, share,
           part_s, drive);
    velocity += part_s * drive.acceleration_mps2;
    position += part_s * velocity;
  };
  for (double time_s = -told.motion.age_s; time_s < -1e-9;) {
    const double part_s = std::min(step_s, -time_s);
    advance(time_s, part_s);
    time_s += part_s;
  }
  std::vector<Vector2d> places{position};
  for (std::size_t k = 1; k < steps; ++k) {
    advance((2.0 * static_cast<double>(k) - 2.0) * step_s, step_s);
    advance((2.0 * static_cast<double>(k) - 1.0) * step_s, step_s);
    places.push_back(position);
  }
  return places;
}

TEST(BrakePath, ManySideBySideAreEachAsAlone) {
  core::RandomStream random(1, "side by side");
  std::vector<Told> told(60);
  std::vector<Forecast> forecasts;
  for (Told& each : told) {
    each = randomTold(random);
    each.motion.commands = std::span(each.commands).first(random.index(4));
    for (const Pace pace : {Pace::kAssumed, Pace::kSlowest}) {
      forecasts.push_back({&each.motion, &each.bounds, pace,
                           random.chance(0.5) ? Arrival::kAll : Arrival::kLastIsLost,
                           random.chance(0.5) ? &each.next : nullptr});
    }
  }
  std::vector<Path> paths(forecasts.size());
  predict(forecasts, paths);
  for (std::size_t i = 0; i < forecasts.size(); ++i) {
    Path alone;
    predict(forecasts[i], alone);
    EXPECT_TRUE(std::ranges::equal(paths[i].points(), alone.points())) << i;
  }
}

TEST(BrakePath, FollowsTheLawsOfMotionStepByStep) {
  core::RandomStream random(2, "step by step");
  for (int i = 0; i < 200; ++i) {
    Told told = randomTold(random);
    told.bounds.inner_lag_s = 0.15;
    told.bounds.max_turn_rate_radps = MotionBounds().max_turn_rate_radps;
    told.motion.commands = told.commands;
    for (const Pace pace : {Pace::kAssumed, Pace::kSlowest}) {
      Path path;
      predict({&told.motion, &told.bounds, pace, Arrival::kAll, &told.next}, path);
      const std::size_t steps = path.points().size() - 1;  // the last one is where it rests
      ASSERT_GE(steps, 8U);
      const std::vector<Vector2d> places = stepByStep(told, pace, steps);
      for (std::size_t k = 0; k < steps; ++k) {
        ASSERT_NEAR((path.points()[k] - places[k]).norm(), 0.0, 1e-9) << i << ", step " << k;
      }
    }
  }
}

}  // namespace
}  // namespace roundabout::planner::shield
