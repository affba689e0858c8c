#include "mocap_bridge/make_source.h"

#include "common/core/error.h"
#include "mocap_bridge/sources/replay/replay.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr const char* kReplay = "replay";

}  // namespace

std::unique_ptr<Source> makeSource(const config::Experiment& experiment) {
  if (experiment.source == "sim") {
    throw core::StartupError(experiment.file, "source",
                             "a motion-capture system (as natnet) or replay",
                             "sim, whose states the simulator publishes itself");
  }
  if (experiment.source == kReplay) {
    return std::make_unique<ReplaySource>(experiment.mocap);
  }
  return protocolNamed(experiment.source).make_session(experiment.mocap);
}

std::string usualAxes(const config::Experiment& experiment) {
  if (experiment.source != kReplay) {
    return std::string(protocolNamed(experiment.source).usual_axes);
  }
  return looksLikeEventLog(experiment.mocap.file)
             ? "z_up"
             : std::string(protocolNamed(experiment.mocap.protocol).usual_axes);
}

}  // namespace roundabout::mocap_bridge
