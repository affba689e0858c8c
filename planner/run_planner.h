#pragma once

#include <string>

#include "common/app/app.h"

namespace roundabout::planner {

struct PlannerOptions {
  static constexpr const char* kName = "planner";
  static constexpr const char* kDescription =
      "Plans for one vehicle: vehicle states in, 10 Hz commands out.";

  std::string vehicle;

  void addOptions(CLI::App& app) {
    app.add_option("--vehicle", vehicle, "Name of the vehicle, as in the experiment file")
        ->required();
  }
};

/// Runs until SIGINT or SIGTERM. The vehicle holds by itself when its planner ends.
int runPlanner(const PlannerOptions& options, app::Context& context);

}  // namespace roundabout::planner
