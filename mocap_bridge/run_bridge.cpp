#include "mocap_bridge/run_bridge.h"

#include <chrono>
#include <ctime>

#include <spdlog/spdlog.h>

#include "common/app/real_time.h"
#include "common/bus/lcm_bus.h"
#include "common/core/error.h"
#include "mocap_bridge/bridge_node.h"
#include "mocap_bridge/local_clock.h"
#include "mocap_bridge/make_source.h"

namespace roundabout::mocap_bridge {

namespace {

// 60 frames of a publisher at 200 Hz.
constexpr std::chrono::milliseconds kListenBeforeTalking{300};

void waitUntil(core::Utime deadline, core::Utime now, const std::vector<pollfd>& descriptors) {
  std::vector<pollfd> waiting = descriptors;
  const core::Utime left = std::max<core::Utime>(deadline - now, 0);
  const timespec time{left / core::kMicrosPerSecond, left % core::kMicrosPerSecond * 1000};
  ppoll(waiting.data(), waiting.size(), &time, nullptr);
}

}  // namespace

int runBridge(const BridgeOptions& /*options*/, app::Context& context) {
  const config::Experiment& experiment = context.experiment;
  const LocalClock clock;
  std::unique_ptr<Source> source = makeSource(experiment);
  source->setArrivalClock([&clock] { return clock.now(); });
  {
    bus::LcmBus listener(context.lcm_url);
    requireSolePublisher(listener, context.lcm_url, kListenBeforeTalking);
  }
  app::requestRealTimePriority(app::kFramePriority);
  app::requestLockedMemory();
  bus::LcmBus bus(context.lcm_url);
  BridgeNode node(experiment, std::move(source), usualAxes(experiment), bus);
  spdlog::info("{} vehicles from {} on {}", experiment.vehicles.size(), experiment.source,
               context.lcm_url);

  std::vector<pollfd> descriptors;
  const bool stepped = experiment.source == "replay" && experiment.mocap.speed == 0.0;
  while (!context.stop.requested() && !node.finished()) {
    node.poll(clock.now());
    for (const std::string& note : node.takeNotes()) {
      spdlog::warn("{}", note);
    }
    descriptors = {{context.stop.fileDescriptor(), POLLIN, 0}};
    node.addDescriptors(descriptors);
    const core::Utime now = clock.now();
    // A recording has no descriptor to wait for.
    const core::Utime longest = experiment.source == "replay" ? (stepped ? 0 : 1000) : 20'000;
    waitUntil(std::min(node.nextDeadline(now), now + longest), now, descriptors);
  }
  spdlog::info("{}", node.report());
  return 0;
}

}  // namespace roundabout::mocap_bridge
