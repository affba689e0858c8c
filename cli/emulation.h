#pragma once

#include <string>
#include <vector>

namespace roundabout::cli {

/// Overrides of an experiment file with which the bridge listens to an emulated motion-capture
/// system on this machine, on ports that nobody else uses, whatever the file says of the lab's.
std::vector<std::string> emulationOverrides(const std::string& protocol);

}  // namespace roundabout::cli
