#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::learning {

/// `roundabout cross`.
void addCrossCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::learning
