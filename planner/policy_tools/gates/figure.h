#pragma once

#include <filesystem>
#include <vector>

#include "planner/policy_tools/gates/analysis.h"

namespace roundabout::planner {

/// Draws the paper's figure "Gate Dynamics on Single Timestep", a row for each scene: the agents,
/// numbered in the order in which they are read, and the parts of the input gate as each is added.
/// Writes `file`.png and `file`.svg. Throws as plot::GnuplotScript::run does.
void drawGates(const std::vector<GateAnalysis>& analyses, const std::filesystem::path& file);

}  // namespace roundabout::planner
