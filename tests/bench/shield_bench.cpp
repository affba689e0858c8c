// Policy and shield together, with everybody else in the densest ring.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>

#include "common/core/random.h"
#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/shield/shield.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;

constexpr double kRadius_m = 0.35;

// Computing time of this thread: a scheduler's slices are not the query's.
double spent_us() {
  timespec spent{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return 1e6 * static_cast<double>(spent.tv_sec) + 1e-3 * static_cast<double>(spent.tv_nsec);
}

struct RingScene {
  core::EgoAgent ego;
  std::vector<core::OtherAgent> others;
  shield::Ego shielded;
  std::vector<shield::Neighbour> neighbours;
};

// One of them and the others go round side by side, a hand's breadth apart, and want to cross.
RingScene ringWith(int others, core::RandomStream& random, const shield::MotionBounds& bounds) {
  RingScene scene;
  const int all = others + 1;
  const double ring_m = all * (2.0 * kRadius_m + 0.1) / (2.0 * std::numbers::pi);
  for (int i = 0; i < all; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + random.uniform(-0.05, 0.05)) / all;
    const Vector2d out(std::cos(angle), std::sin(angle));
    const Vector2d position = (ring_m + random.uniform(-0.1, 0.1)) * out;
    const Vector2d velocity = random.uniform(0.1, 0.6) * Vector2d(-out.y(), out.x());
    shield::Motion motion;
    motion.position_world_m = position;
    motion.velocity_world_mps = velocity;
    motion.age_s = 0.02;
    if (i == 0) {
      scene.ego = {position, velocity, angle + 1.57, -3.0 * out * ring_m, 1.0, 0.4};
      scene.shielded = {motion, bounds, kRadius_m, scene.ego.goal_world_m, 1.0, 1.0, 0, false};
      continue;
    }
    scene.others.push_back({position, velocity, 0.4, i});
    shield::Neighbour& neighbour = scene.neighbours.emplace_back();
    neighbour.motion = motion;
    neighbour.bounds = bounds;
    neighbour.radius_m = kRadius_m;
    neighbour.id = i;
  }
  return scene;
}

void queryBehindTheShield(benchmark::State& state, const shield::ShieldParameters& parameters,
                          const shield::MotionBounds& bounds) {
  core::RandomStream random(1, "rings");
  std::vector<RingScene> scenes;
  for (int i = 0; i < 256; ++i) {
    scenes.push_back(ringWith(static_cast<int>(state.range(0)), random, bounds));
  }
  Ga3cCadrl policy(toGa3cCadrlWeights(test::randomGa3cCadrl(1), "random"));
  shield::Shield guard(parameters);
  const std::vector<shield::SentCommand> sent{{Vector2d(0.3, 0.1), 0.2, parameters.hold_s},
                                              {Vector2d(0.2, 0.2), 0.1, parameters.hold_s}};
  std::vector<double> durations_us;
  std::size_t next = 0;
  for (auto _ : state) {
    RingScene& scene = scenes[next % scenes.size()];
    if (bounds.lag_s > 0.0) {
      scene.shielded.motion.commands = sent;
      for (shield::Neighbour& neighbour : scene.neighbours) {
        neighbour.motion.commands = sent;
      }
    }
    const double began_us = spent_us();
    const Decision decision = policy.decide(scene.ego, scene.others);
    const double heading = scene.ego.heading_world_rad + decision.heading_change_rad;
    const Vector2d wanted = decision.speed_mps * Vector2d(std::cos(heading), std::sin(heading));
    benchmark::DoNotOptimize(guard.decide(scene.shielded, scene.neighbours, {}, wanted,
                                          0.1 * static_cast<double>(next)));
    durations_us.push_back(spent_us() - began_us);
    ++next;
  }
  std::sort(durations_us.begin(), durations_us.end());
  const auto at = [&](double share) {
    return durations_us[static_cast<std::size_t>(share *
                                                 static_cast<double>(durations_us.size() - 1))];
  };
  state.counters["median_us"] = at(0.5);
  state.counters["p99_us"] = at(0.99);
}

void shieldedIdeal(benchmark::State& state) {
  queryBehindTheShield(state, shield::ShieldParameters::idealRules(), {});
}
BENCHMARK(shieldedIdeal)->ArgName("others")->Arg(3)->Arg(9)->Arg(19);

void shieldedLab(benchmark::State& state) {
  shield::MotionBounds bounds;
  bounds.delay_s = 0.1;
  bounds.lag_s = 1.0 / 3.0;
  bounds.inner_lag_s = 0.15;
  bounds.reserve = 1.5;
  bounds.max_acceleration_mps2 = 3.0;
  bounds.max_jerk_mps3 = 30.0;
  queryBehindTheShield(state, shield::ShieldParameters::lab(), bounds);
}
BENCHMARK(shieldedLab)->ArgName("others")->Arg(3)->Arg(9)->Arg(19);

}  // namespace
}  // namespace roundabout::planner
