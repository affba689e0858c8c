#include <benchmark/benchmark.h>

#include "common/bus/memory_bus.h"
#include "sim/sim_node.h"

namespace roundabout::sim {
namespace {

config::Experiment vehicles(std::int64_t count) {
  config::Experiment experiment;
  for (std::int64_t i = 0; i < count; ++i) {
    experiment.vehicles.emplace_back().name = "hex" + std::to_string(i + 1);
  }
  experiment.sim.start_area = {{-20.0, -20.0}, {20.0, 20.0}};
  return experiment;
}

// Ten commands a second to hover above the own place.
void commandAll(World& world) {
  core::Command command;
  command.mode = core::CommandMode::kPosition;
  command.valid_for_s = 0.3;
  command.utime = world.now();
  for (std::size_t i = 0; i < world.bodies().size(); ++i) {
    command.position_world_m = world.bodies()[i].position_world_m;
    command.position_world_m.z() = 1.0;
    world.accept(i, command);
  }
}

// Autopilots, multirotors, contacts; items are steps of one vehicle.
void simWorldStep(benchmark::State& state) {
  World world(vehicles(state.range(0)), core::kMicrosPerSecond);
  for (auto _ : state) {
    if (world.now() % 100'000 == 0) {
      commandAll(world);
    }
    world.step();
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(simWorldStep)->Arg(1)->Arg(6)->Arg(16)->Arg(100);

// The same, with motion capture, the message and its encoding; items are frames of one vehicle.
void simFrame(benchmark::State& state) {
  bus::MemoryBus bus(std::make_shared<bus::MemoryNetwork>());
  SimNode node(vehicles(state.range(0)), bus, core::kMicrosPerSecond);
  for (auto _ : state) {
    node.advance();
    node.publishFrame();
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(simFrame)->Arg(1)->Arg(6)->Arg(16)->Arg(100);

}  // namespace
}  // namespace roundabout::sim
