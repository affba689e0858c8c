#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::learning {

/// Adds `evaluate`: policies on the same test cases. Sets exit_status to 130 if it was interrupted.
/// Errors leave as exceptions from the parser (core::StartupError).
void addEvaluateCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::learning
