#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// `roundabout fly FILE`: flies an experiment file and leaves log, metrics, report and pictures in
/// a folder. Exit status 0: every formation was formed and no bodies touched; 1: not so; 2: could
/// not start; 130: interrupted.
void addFlyCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
