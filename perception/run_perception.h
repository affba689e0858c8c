#pragma once

#include <string>

#include "common/app/app.h"

namespace roundabout::perception {

struct PerceptionOptions {
  static constexpr const char* kName = "perception";
  static constexpr const char* kDescription =
      "Sees for one vehicle: laser scans and images in, tracks of everybody around and a map out.";

  std::string vehicle;

  void addOptions(CLI::App& app) {
    app.add_option("--vehicle", vehicle, "Name of the vehicle, as in the experiment file")
        ->required();
  }
};

/// Runs until SIGINT or SIGTERM, then saves perception.map_file. The vehicle's planner holds when
/// its perception ends.
int runPerception(const PerceptionOptions& options, app::Context& context);

}  // namespace roundabout::perception
