#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::logs {

/// Adds `log` with its commands. They run while the app parses; a
/// core::StartupError leaves app.parse().
void addLogCommands(CLI::App& app);

}  // namespace roundabout::logs
