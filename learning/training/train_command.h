#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::learning {

/// Adds `train`: a recipe, run from nothing or from where it was stopped. Sets exit_status to 130
/// if it was interrupted. Errors leave as exceptions from the parser (core::StartupError).
void addTrainCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::learning
