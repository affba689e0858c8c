#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::planner {

/// Adds `policy import`, `info`, `query` and `gates` to `parent`. They run while it parses;
/// failures leave as core::StartupError, and as CLI::RuntimeError (exit status 1) after a query
/// with bad lines.
void addPolicyCommands(CLI::App& parent);

}  // namespace roundabout::planner
