// One query of the learned policy, from agents to a decision.

#include <memory>

#include <benchmark/benchmark.h>

#include "common/core/random.h"
#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "tests/planner/policies/random_scene.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

// As many different situations as keep the processor from learning one by heart.
constexpr std::size_t kScenes = 256;

std::vector<Scene> scenesWith(std::size_t num_others) {
  core::RandomStream random(1, "scenes");
  std::vector<Scene> scenes;
  for (std::size_t i = 0; i < kScenes; ++i) {
    scenes.push_back(randomScene(random, num_others, 5.0));
  }
  return scenes;
}

void queryGa3cCadrl(benchmark::State& state) {
  const std::vector<Scene> scenes = scenesWith(static_cast<std::size_t>(state.range(0)));
  Ga3cCadrl policy(toGa3cCadrlWeights(test::randomGa3cCadrl(1), "random"));
  std::size_t next = 0;
  for (auto _ : state) {
    const Scene& scene = scenes[next++ % kScenes];
    benchmark::DoNotOptimize(policy.decide(scene.ego, scene.others));
  }
}
BENCHMARK(queryGa3cCadrl)->ArgName("others")->Arg(0)->Arg(3)->Arg(9)->Arg(19);

void encodeObservation(benchmark::State& state) {
  const std::vector<Scene> scenes = scenesWith(static_cast<std::size_t>(state.range(0)));
  ObservationEncoder encoder(19, OthersOrder::kClosestLast);
  std::size_t next = 0;
  for (auto _ : state) {
    const Scene& scene = scenes[next++ % kScenes];
    benchmark::DoNotOptimize(encoder.encode(scene.ego, scene.others).others.data());
  }
}
BENCHMARK(encodeObservation)->ArgName("others")->Arg(3)->Arg(19);

}  // namespace
}  // namespace roundabout::planner
