#include <benchmark/benchmark.h>

#include "planner/policies/orca/orca.h"
#include "tests/planner/policies/random_scene.h"

namespace roundabout::planner {
namespace {

// Arguments: number of others; half the side of the square they are in, decimetres. The smaller it
// is, the more often no velocity keeps every half-plane, which costs most.
void orcaQuery(benchmark::State& state) {
  core::RandomStream random(1, "bench");
  std::vector<Scene> scenes(1000);
  for (Scene& scene : scenes) {
    scene = randomScene(random, static_cast<std::size_t>(state.range(0)),
                        static_cast<double>(state.range(1)) / 10.0);
  }
  const auto policy = makeOrca({});
  std::size_t next = 0;
  for (auto _ : state) {
    const Scene& scene = scenes[next++ % scenes.size()];
    benchmark::DoNotOptimize(policy->decide(scene.ego, scene.others));
  }
}
BENCHMARK(orcaQuery)->ArgNames({"others", "half_side_dm"})->ArgsProduct({{3, 19, 40}, {20, 100}});

}  // namespace
}  // namespace roundabout::planner
