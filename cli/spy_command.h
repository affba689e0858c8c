#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// Adds `spy`: what is heard on a URL, live. Runs while the app parses and sets the exit status.
void addSpyCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
