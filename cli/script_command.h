#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// Adds `script`: runs a Python or Lua script with Roundabout's modules in its path. The process
/// becomes the interpreter's.
void addScriptCommand(CLI::App& app);

}  // namespace roundabout::cli
