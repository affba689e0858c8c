#pragma once

#include <string>

#include "common/config/experiment.h"

namespace roundabout::cli {

/// Two flights on one URL would fly each other's vehicles, and a planner or fleet that was started
/// by hand and forgotten would wake up in this one. Listens for a few messages' time; throws
/// core::StartupError that names the channels on which somebody is heard.
void requireNobodyFlies(const config::Experiment& experiment, const std::string& lcm_url);

}  // namespace roundabout::cli
