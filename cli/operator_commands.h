#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// `roundabout order hold|land|kill|resume`: an operator's word to the planners of one vehicle or
/// all. Says who obeyed; exit status 1 if somebody did not, or no planner is heard.
void addOrderCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
