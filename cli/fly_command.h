#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// `roundabout fly FILE`: flies an experiment file and leaves log, metrics, report and pictures in
/// a folder. Exit status 0: the log is complete and `roundabout log metrics` calls it a success; 1:
/// not so; 2: could not start; 130: interrupted. Pictures that cannot be drawn change none of it.
void addFlyCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
