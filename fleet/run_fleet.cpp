#include "fleet/run_fleet.h"

#include <chrono>

#include <spdlog/spdlog.h>

#include "common/bus/lcm_bus.h"
#include "fleet/fleet_node.h"

namespace roundabout::fleet {

int runFleet(const FleetOptions& /*options*/, app::Context& context) {
  bus::LcmBus bus(context.lcm_url);
  FleetNode node(context.experiment, bus);
  spdlog::info("{} vehicles on {}", context.experiment.vehicles.size(), context.lcm_url);
  while (!context.stop.requested()) {
    bus.handle(std::chrono::milliseconds(50));
    node.onWallClock(std::chrono::steady_clock::now());
  }
  return 0;
}

}  // namespace roundabout::fleet
