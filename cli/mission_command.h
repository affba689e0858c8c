#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// Adds `mission`: gives the fleet steps to fly, or says what it is doing. Runs while the app
/// parses and sets the exit status: 1 if the fleet refuses, or is not heard.
void addMissionCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
