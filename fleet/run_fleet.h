#pragma once

#include "common/app/app.h"

namespace roundabout::fleet {

struct FleetOptions {
  static constexpr const char* kName = "fleet";
  static constexpr const char* kDescription =
      "Flies the experiment's mission, and what comes by MISSION: gives every vehicle its goals.";

  void addOptions(CLI::App& /*app*/) {}
};

/// Runs until SIGINT or SIGTERM. Vehicles stay at their goals when it ends; a restarted fleet takes
/// over.
int runFleet(const FleetOptions& options, app::Context& context);

}  // namespace roundabout::fleet
