#pragma once

#include "common/app/app.h"

namespace roundabout::mocap_bridge {

struct BridgeOptions {
  static constexpr const char* kName = "mocap_bridge";
  static constexpr const char* kDescription =
      "Takes rigid bodies from a motion-capture system and publishes VEHICLE_STATES.";

  void addOptions(CLI::App& /*app*/) {}
};

/// Runs until a recording has ended, SIGINT or SIGTERM. Throws core::StartupError if the
/// experiment's source is none of the bridge's, its settings are wrong, or somebody else publishes.
int runBridge(const BridgeOptions& options, app::Context& context);

}  // namespace roundabout::mocap_bridge
