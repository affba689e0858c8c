// One decision of SA-CADRL: 47 candidates through the value network.

#include <benchmark/benchmark.h>

#include "planner/policies/cadrl/cadrl.h"
#include "planner/policies/cadrl/weights.h"
#include "tests/planner/policies/random_scene.h"
#include "tests/support/cadrl_weights.h"

namespace roundabout::planner {
namespace {

constexpr std::size_t kScenes = 256;

void queryCadrl(benchmark::State& state) {
  core::RandomStream random(1, "scenes");
  std::vector<Scene> scenes;
  for (std::size_t i = 0; i < kScenes; ++i) {
    scenes.push_back(randomScene(random, static_cast<std::size_t>(state.range(0)), 5.0));
  }
  Cadrl policy(toCadrlWeights(test::randomCadrl(), "random"));
  std::size_t next = 0;
  for (auto _ : state) {
    const Scene& scene = scenes[next++ % kScenes];
    benchmark::DoNotOptimize(policy.decide(scene.ego, scene.others));
  }
}
BENCHMARK(queryCadrl)->ArgName("others")->Arg(1)->Arg(3)->Arg(9)->Arg(19);

}  // namespace
}  // namespace roundabout::planner
