#pragma once

#include <filesystem>
#include <string>

#include "learning/evaluation/crossing/crossing.h"

namespace roundabout::learning {

/// One run seen from above: the robot's body and the people within 2.5 m of it, whose circles get
/// lighter with time; the star is the goal, a cross a collision. Writes `file` with the endings
/// .png and .svg. Throws core::StartupError if gnuplot is missing.
void drawCrossing(const config::Experiment& experiment, const CrossingTrace& trace,
                  const std::string& title, const std::filesystem::path& file);

}  // namespace roundabout::learning
