#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::mocap_bridge {

/// Adds `mocap` with its commands decode, watch, record and emulate. They run while the app parses;
/// a core::StartupError leaves app.parse().
void addMocapCommands(CLI::App& app, int& exit_status);

}  // namespace roundabout::mocap_bridge
