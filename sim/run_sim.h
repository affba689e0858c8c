#pragma once

#include "common/app/app.h"

namespace roundabout::sim {

struct SimOptions {
  static constexpr const char* kName = "sim";
  static constexpr const char* kDescription =
      "Simulates vehicles and motion capture: commands in, 200 Hz vehicle states out.";

  void addOptions(CLI::App& app) {
    app.add_flag("--scene", scene,
                 "Publishes what cameras would see, for `roundabout mocap emulate --scene sim`, "
                 "instead of states");
  }

  bool scene = false;
};

/// Runs until the mission has ended, sim.max_duration_s, SIGINT or SIGTERM. Throws
/// core::StartupError if the experiment has another source of states, or somebody publishes them.
int runSim(const SimOptions& options, app::Context& context);

}  // namespace roundabout::sim
