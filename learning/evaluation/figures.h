#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "learning/evaluation/scores.h"

namespace roundabout::learning {

/// Grouped bars as in the paper's comparison: failures (collision, stuck) and extra time to goal
/// (mean, 75th and 90th percentile) by group, a bar for each contestant. Writes comparison.png and
/// comparison.svg. Throws core::StartupError if gnuplot is missing.
void drawComparison(const Evaluation& evaluation, const std::vector<Score>& scores,
                    const std::filesystem::path& folder);

/// The way of all agents of one row, in the paper's style: circles of their radius that get lighter
/// with time, with the time in s beside them; stars are goals. Writes a PNG and an SVG file for
/// each set of goals; returns what their names begin with.
std::string drawTrajectories(const Evaluation& evaluation, std::size_t row,
                             const std::filesystem::path& folder);

/// The same as an animation in real time, a GIF file. Returns its name.
std::string animate(const Evaluation& evaluation, std::size_t row,
                    const std::filesystem::path& folder);

}  // namespace roundabout::learning
