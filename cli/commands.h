#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// Everything that `roundabout` can do. Commands run while the app parses and set the exit status;
/// a core::StartupError leaves app.parse().
void addCommands(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
