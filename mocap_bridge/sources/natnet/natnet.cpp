#include "common/core/error.h"
#include "mocap_bridge/sources/natnet/emulator.h"
#include "mocap_bridge/sources/natnet/session.h"
#include "mocap_bridge/sources/table.h"

namespace roundabout::mocap_bridge {

namespace {

std::unique_ptr<Source> makeSession(const config::Mocap& mocap) {
  return std::make_unique<natnet::NatnetSession>(mocap);
}

std::unique_ptr<Interpreter> makeInterpreter(const config::Mocap& mocap) {
  natnet::NatnetInterpreter::Settings settings{std::nullopt, mocap.latency_s, mocap.rate_hz};
  if (!mocap.version.empty()) {
    settings.version = natnet::parseVersion(mocap.version);
    if (!settings.version) {
      throw core::StartupError("natnet", "version", "one like 2.7, from 2.0 on",
                               "\"" + mocap.version + "\"");
    }
  }
  return std::make_unique<natnet::NatnetInterpreter>(settings);
}

std::unique_ptr<Emulator> makeEmulator(const EmulatorSettings& settings) {
  return std::make_unique<natnet::NatnetEmulator>(settings);
}

}  // namespace

namespace natnet {

Protocol protocol() { return {"natnet", "y_up", 0, makeSession, makeInterpreter, makeEmulator}; }

}  // namespace natnet

}  // namespace roundabout::mocap_bridge
