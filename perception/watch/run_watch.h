#pragma once

#include <string>

#include "common/app/app.h"

namespace roundabout::perception {

struct WatchOptions {
  static constexpr const char* kName = "perception_watch";
  static constexpr const char* kDescription =
      "Shows from above what a vehicle's perception sees: scan, clusters, tracks, map and images. "
      "It listens only, and does perception's work again to see the inside of it.";

  std::string vehicle;
  std::string record;
  std::string picture;
  bool no_window = false;
  double seconds = 0.0;

  void addOptions(CLI::App& app) {
    app.add_option("--vehicle", vehicle, "Name of the vehicle, as in the experiment file")
        ->required();
    app.add_option("--record", record, "Video file (.avi), ten pictures a second of data time");
    app.add_option("--picture", picture, "The last picture goes to this file (.png, .jpg)");
    app.add_option("--seconds", seconds, "Ends after so much data time; 0: on Ctrl-C");
    app.add_flag("--no-window", no_window, "Only records; so it is where there is no display");
  }
};

/// Runs until SIGINT, SIGTERM or --seconds.
int runWatch(const WatchOptions& options, app::Context& context);

}  // namespace roundabout::perception
