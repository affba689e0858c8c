// From a sweep to tracks, and from a sweep to the map.

#include <algorithm>
#include <chrono>
#include <ctime>

#include <benchmark/benchmark.h>

#include "perception/agent_finder.h"
#include "perception/clustering/table.h"
#include "perception/mapping/occupancy_mapper.h"
#include "planner/map/way_finder.h"
#include "sim/sensors/depth_camera.h"
#include "tests/perception/crowd.h"

namespace {

using namespace roundabout;

constexpr double kPeriod_s = 0.025;

// What the thread has worked; the machine may be shared.
double threadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

test::CrowdSettings crowdOf(int people) {
  test::CrowdSettings settings;
  settings.people = people;
  settings.walls = true;
  settings.closest_m = 0.5;
  return settings;
}

// 1080 beams over 270 degrees in a room of 14 m, one sweep an iteration; the map is known.
void scanToTracks(benchmark::State& state, const char* clusterer) {
  test::Crowd crowd(crowdOf(static_cast<int>(state.range(0))));
  perception::AgentFinder finder({}, perception::makeClusterer(clusterer, "bench"));
  perception::OccupancyMapper mapper(0.05, {Eigen::Vector2d(-8, -8), Eigen::Vector2d(8, 8)});
  std::vector<core::LaserScan> scans;
  std::vector<double> times_s;
  std::vector<double> cpu_times_s;
  for (int i = 0; i < 2000; ++i) {
    crowd.step(kPeriod_s);
    scans.push_back(crowd.scan());
  }
  finder.update(scans[0], {}, {}, nullptr);
  mapper.insert(perception::mapUpdateOf(finder, 6.0));
  const auto cells = mapper.cells();
  std::size_t next = 1;
  for (auto _ : state) {
    if (next == scans.size()) {
      finder.forget();
      next = 1;
    }
    const auto begin = std::chrono::steady_clock::now();
    const double cpu_begin_s = threadSeconds();
    finder.update(scans[next++], {}, {}, cells.get());
    benchmark::DoNotOptimize(finder.tracker().tracks());
    times_s.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    cpu_times_s.push_back(threadSeconds() - cpu_begin_s);
  }
  std::sort(times_s.begin(), times_s.end());
  state.counters["p99_us"] = 1e6 * times_s[times_s.size() * 99 / 100];
  std::sort(cpu_times_s.begin(), cpu_times_s.end());
  state.counters["cpu_p99_us"] = 1e6 * cpu_times_s[cpu_times_s.size() * 99 / 100];
}
BENCHMARK_CAPTURE(scanToTracks, breakpoints, "breakpoints")
    ->Arg(6)
    ->Arg(12)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(scanToTracks, dynamic_means, "dynamic_means")
    ->Arg(6)
    ->Arg(12)
    ->Unit(benchmark::kMicrosecond);

// The same sweeps into an OctoMap of 16 m with cells of 5 cm.
void scanToMap(benchmark::State& state) {
  test::Crowd crowd(crowdOf(6));
  perception::AgentFinder finder({}, perception::makeClusterer("breakpoints", "bench"));
  perception::OccupancyMapper mapper(0.05, {Eigen::Vector2d(-8, -8), Eigen::Vector2d(8, 8)});
  for (auto _ : state) {
    state.PauseTiming();
    crowd.step(0.1);
    finder.update(crowd.scan(), {}, {}, nullptr);
    const perception::MapUpdate update = perception::mapUpdateOf(finder, 6.0);
    state.ResumeTiming();
    mapper.insert(update);
    benchmark::DoNotOptimize(mapper.cells());
  }
}
BENCHMARK(scanToMap)->Unit(benchmark::kMillisecond);

// A depth picture of 160 x 120 pixels of a box in a room of 6 m: its places, and into the map.
void depthsToMap(benchmark::State& state) {
  config::Camera camera;
  camera.width = 160;
  camera.height = 120;
  camera.depth = config::DepthSensing{0.3, 4.0, 0.0025, 0.05};
  const sim::Prism box{{{1.5, -0.3}, {1.9, -0.3}, {1.9, 0.4}, {1.5, 0.4}}, 0.0, 0.15};
  const Eigen::AlignedBox2d room(Eigen::Vector2d(-3, -3), Eigen::Vector2d(3, 3));
  core::RandomStream noise(1, "bench");
  sim::DepthCamera sees(camera);
  const auto depths = sees.render({0, 0}, 0.0, {{&box, 1}, {}, room}, &noise);
  const perception::DepthView view{
      {0, camera.width, camera.height, {depths.begin(), depths.end()}}, camera, {}, {}};
  perception::OccupancyMapper mapper(0.05, {Eigen::Vector2d(-8, -8), Eigen::Vector2d(8, 8)});
  for (auto _ : state) {
    mapper.insert(perception::depthUpdateOf(view, {0.06, 0.8}, 0.05));
  }
}
BENCHMARK(depthsToMap)->Unit(benchmark::kMillisecond);

void mapToMessage(benchmark::State& state) {
  test::Crowd crowd(crowdOf(6));
  perception::AgentFinder finder({}, perception::makeClusterer("breakpoints", "bench"));
  perception::OccupancyMapper mapper(0.05, {Eigen::Vector2d(-8, -8), Eigen::Vector2d(8, 8)});
  crowd.step(0.1);
  finder.update(crowd.scan(), {}, {}, nullptr);
  mapper.insert(perception::mapUpdateOf(finder, 6.0));
  std::size_t bytes = 0;
  for (auto _ : state) {
    bytes = mapper.binaryTree().size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(mapToMessage)->Unit(benchmark::kMillisecond);

// A planner's tick behind a wall, 12 m x 12 m in cells of 5 cm: the way round it, and the mask.
void wayRoundAWall(benchmark::State& state) {
  planner::OccupancyGrid grid({Eigen::Vector2d(-6, -6), Eigen::Vector2d(6, 6)}, 0.05);
  grid.occupy({Eigen::Vector2d(0.0, -5.5), Eigen::Vector2d(0.05, 3.0)});
  const planner::WayFinder finder({}, grid);
  for (auto _ : state) {
    benchmark::DoNotOptimize(finder.nextLeg({-4, -4}, {4, -4}));
    benchmark::DoNotOptimize(finder.maskedVelocity({-0.6, 0}, {1.2, 0}, 1.0));
  }
}
BENCHMARK(wayRoundAWall)->Unit(benchmark::kMillisecond);

void mapToPlanner(benchmark::State& state) {
  planner::OccupancyGrid grid({Eigen::Vector2d(-6, -6), Eigen::Vector2d(6, 6)}, 0.05);
  grid.occupy({Eigen::Vector2d(-6, -6), Eigen::Vector2d(6, -5.95)});
  grid.occupy({Eigen::Vector2d(-6, 5.95), Eigen::Vector2d(6, 6)});
  for (auto _ : state) {
    benchmark::DoNotOptimize(planner::WayFinder({}, grid));
  }
}
BENCHMARK(mapToPlanner)->Unit(benchmark::kMillisecond);

}  // namespace
