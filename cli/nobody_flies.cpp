#include "cli/nobody_flies.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include <spdlog/fmt/ranges.h>

#include "common/bus/lcm_bus.h"
#include "common/bus/listen.h"
#include "common/bus/messages.h"
#include "common/core/error.h"

namespace roundabout::cli {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kShortest(300);

// Planners and fleet announce themselves at their rates.
milliseconds longEnough(const config::Experiment& experiment) {
  const double slowest_hz = std::min(experiment.planner.rate_hz, experiment.fleet.rate_hz);
  const std::chrono::duration<double> period(1.0 / slowest_hz);
  return std::max(kShortest, std::chrono::ceil<milliseconds>(1.5 * period));
}

}  // namespace

void requireNobodyFlies(const config::Experiment& experiment, const std::string& lcm_url) {
  std::vector<std::string> channels{bus::kStatesChannel, bus::kFleetStatusChannel};
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    channels.push_back(bus::plannerStatusChannel(vehicle.name));
  }
  bus::LcmBus bus(lcm_url);
  const auto heard = bus::heardWithin(longEnough(experiment), bus, channels);
  if (!heard.empty()) {
    throw core::StartupError(lcm_url, "a flight of its own",
                             "nobody on this URL (stop what runs, or use another --lcm-url)",
                             fmt::format("{}", fmt::join(heard, ", ")));
  }
}

}  // namespace roundabout::cli
