#pragma once

#include <string>
#include <vector>

namespace roundabout::mocap_bridge {

struct DecodeOptions {
  std::string protocol = "natnet";
  std::string version;
  std::vector<std::string> files;
};

/// Prints one line of JSON a packet or frame. Returns 0, or 1 if a packet could not be understood.
/// Throws core::StartupError: a file that cannot be read, a version that is none.
int decode(const DecodeOptions& options);

}  // namespace roundabout::mocap_bridge
