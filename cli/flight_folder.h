#pragma once

#include <filesystem>
#include <string>

#include "common/config/experiment.h"

namespace roundabout::cli {

/// Makes the folder that a flight leaves its files in and writes the resolved experiment.yaml
/// there. `wanted` empty: out/<experiment>-<YYYYmmdd-HHMMSS> in the working directory, with a
/// number behind it if that is taken. Throws core::StartupError if the folder has files already or
/// cannot be made. Returns an absolute path.
std::filesystem::path makeFlightFolder(const config::Experiment& experiment,
                                       const std::string& wanted);

}  // namespace roundabout::cli
