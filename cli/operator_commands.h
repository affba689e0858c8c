#pragma once

#include <CLI/CLI.hpp>

namespace roundabout::cli {

/// `roundabout order hold|land|kill|resume`: an operator's word to the planners of one vehicle or
/// all. Says who obeyed; exit status 1 if somebody did not, or no planner is heard.
void addOrderCommand(CLI::App& app, int& exit_status);

/// `roundabout mission take_off|spell|hold|land`: one step for the fleet. Exit status 1 if the
/// fleet refuses it, with the reason, or no fleet is heard.
void addMissionCommand(CLI::App& app, int& exit_status);

}  // namespace roundabout::cli
