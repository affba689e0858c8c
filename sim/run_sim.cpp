#include "sim/run_sim.h"

#include <chrono>
#include <cmath>

#include <spdlog/spdlog.h>

#include "common/app/real_time.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/core/error.h"
#include "mocap_bridge/state_publisher.h"
#include "sim/lockstep_pacing.h"
#include "sim/pedestrians/policy_steering.h"
#include "sim/real_time_pacing.h"
#include "sim/sim_node.h"

namespace roundabout::sim {

namespace {

using Clock = std::chrono::steady_clock;

// 60 frames of a publisher at 200 Hz.
constexpr std::chrono::milliseconds kListenBeforeTalking{300};

void logReport(const SimNode& node, Clock::time_point begin) {
  const SimNode::Report report = node.report();
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  spdlog::info(
      "{} frames ({} skipped), {:.2f} s of data in {:.2f} s of wall clock ({:.1f} x real time), "
      "{} collisions in truth ({:.2f} s), closest {:.3f} m, {} messages refused",
      report.frames, report.skipped_frames, report.data_time_s, wall_s, report.data_time_s / wall_s,
      report.contacts, report.contact_s, report.closest_m, report.refused_messages);
  if (std::isfinite(report.closest_person_m)) {
    spdlog::info("people: {} collisions in truth ({} by a vehicle's own motion), closest {:.3f} m",
                 report.encounters, report.encounters_by_vehicle, report.closest_person_m);
  }
}

}  // namespace

int runSim(const SimOptions& options, app::Context& context) {
  const config::Experiment& experiment = context.experiment;
  if (experiment.source != "sim" && !options.scene) {
    throw core::StartupError(experiment.file, "source", "sim", experiment.source);
  }
  if (options.scene && experiment.sim.pacing != "real_time") {
    throw core::StartupError(experiment.file, "sim.pacing",
                             "real_time, which --scene and the system behind it need",
                             experiment.sim.pacing);
  }
  const auto stop = [&context] { return context.stop.requested(); };
  if (!options.scene) {
    bus::LcmBus listener(context.lcm_url);
    mocap_bridge::requireSolePublisher(listener, context.lcm_url, kListenBeforeTalking);
  }
  if (experiment.sim.pacing == "real_time") {
    app::requestRealTimePriority(app::kFramePriority);
  }
  bus::LcmBus bus(context.lcm_url);
  spdlog::info("{} vehicles, {}, on {}", experiment.vehicles.size(), experiment.sim.pacing,
               context.lcm_url);

  if (experiment.sim.pacing == "lockstep") {
    SimNode node(experiment, bus, LockstepPacing::kFirstUtime, bus::kStatesChannel,
                 steeringFor(experiment));
    LockstepPacing pacing(experiment, bus);
    pacing.waitForEverybody(stop);
    const auto begin = Clock::now();
    pacing.run(node, stop);
    logReport(node, begin);
  } else {
    app::requestLockedMemory();
    SimNode node(experiment, bus, RealTimePacing::firstUtime(experiment.sim.mocap.rate_hz),
                 options.scene ? bus::kSceneChannel : bus::kStatesChannel, steeringFor(experiment));
    RealTimePacing pacing(bus);
    const auto begin = Clock::now();
    pacing.run(node, stop);
    logReport(node, begin);
  }
  return 0;
}

}  // namespace roundabout::sim
