#pragma once

#include <string>
#include <vector>

namespace roundabout::mocap_bridge {

struct ListenOptions {
  std::string experiment_file;
  std::vector<std::string> overrides;
  std::string out;       ///< record: file for the packets
  double seconds = 0.0;  ///< 0: until it is stopped
};

/// Each runs the session of the experiment's source until SIGINT, SIGTERM or the time is up, and
/// publishes nothing. Return 0, or 1 if no frame came (watch) or the disk is full (record). Throw
/// core::StartupError as the experiment and the session.
int watch(const ListenOptions& options);
int record(const ListenOptions& options);

}  // namespace roundabout::mocap_bridge
