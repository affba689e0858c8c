#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// Adds `replay`: plays a log, checks a planner against it, or asks another policy. Runs while the
/// app parses and sets the exit status: 1 if a check fails.
void addReplayCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
