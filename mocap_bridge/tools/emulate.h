#pragma once

#include <string>

#include "mocap_bridge/sources/emulator.h"

namespace roundabout::mocap_bridge {

struct EmulateOptions {
  std::string protocol;
  EmulatorSettings settings;
  int bodies = 6;
  std::string scene = "circles";
  std::string lcm_url;
  double seconds = 0.0;  ///< 0: until it is stopped
};

/// Serves until SIGINT or SIGTERM. Returns 0. Throws core::StartupError as the emulator and LcmBus.
int emulate(const EmulateOptions& options);

/// Bodies hex1, hex2 … that circle at a metre's height, nose forward, 1 m/s, in the world's axes.
SourceFrame circlesAt(core::Utime utime, std::int64_t number, int bodies);

}  // namespace roundabout::mocap_bridge
