#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// Adds `doctor`: what is wrong with this machine and the command that mends it. Exit status 1 if
/// something is wrong.
void addDoctorCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
