// One decision of DRLMACA, without and with its critic; and one sweep of the lidar.

#include <benchmark/benchmark.h>

#include "planner/policies/drl_maca/drl_maca.h"
#include "planner/policies/drl_maca/weights.h"
#include "sim/sensors/lidar.h"
#include "tests/planner/policies/random_scene.h"
#include "tests/support/drl_maca_weights.h"

namespace roundabout::planner {
namespace {

std::vector<sim::Disc> discsOf(const Scene& scene) {
  std::vector<sim::Disc> discs;
  for (const core::OtherAgent& other : scene.others) {
    discs.push_back({other.position_world_m, other.radius_m});
  }
  return discs;
}

void queryDrlMaca(benchmark::State& state) {
  core::RandomStream random(1, "scenes");
  const Scene scene = randomScene(random, static_cast<std::size_t>(state.range(0)), 5.0);
  sim::Lidar lidar((config::Lidar()));
  core::Surroundings around;
  around.scan = lidar.sweep({0.0, 0.0}, 0.0, {discsOf(scene)});
  DrlMaca policy(toDrlMacaWeights(test::randomDrlMaca(), "random"), state.range(1) != 0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(policy.decide(scene.ego, around));
  }
}
BENCHMARK(queryDrlMaca)->ArgNames({"others", "value"})->ArgsProduct({{0, 1, 3, 9}, {0, 1}});

void sweepLidar(benchmark::State& state) {
  core::RandomStream random(1, "scenes");
  const Scene scene = randomScene(random, static_cast<std::size_t>(state.range(0)), 5.0);
  const std::vector<sim::Disc> discs = discsOf(scene);
  sim::Lidar lidar((config::Lidar()));
  for (auto _ : state) {
    benchmark::DoNotOptimize(lidar.sweep(scene.ego.position_world_m, 0.0, {discs}).ranges_m.data());
  }
}
BENCHMARK(sweepLidar)->ArgName("others")->Arg(3)->Arg(9)->Arg(19);

}  // namespace
}  // namespace roundabout::planner
