#pragma once

#include <string>
#include <vector>

#include "learning/evaluation/test_case.h"

namespace roundabout::learning {

/// Reads test cases from a CSV file with the columns case, agent, start_x, start_y, goal_x, goal_y
/// (m), radius (m) and pref_speed (m/s), one row per agent; cases and agents count from 0 without
/// gaps; blank lines do not count. Cases of different sizes make a group each. Throws
/// core::StartupError with file, line and column.
std::vector<CaseGroup> readCaseFile(const std::string& path);

/// "4 agents"
std::string agentsText(std::size_t count);
/// "500 cases"
std::string casesText(std::size_t count);

}  // namespace roundabout::learning
