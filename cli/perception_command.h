#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// `roundabout perception watch`.
void addPerceptionCommand(CLI::App& app);

}  // namespace roundabout::cli
