#pragma once

#include <string>

#include "common/config/experiment.h"

namespace roundabout::sim {

/// Measures steps of 1 m/s, 2 m and 90 degrees and stops, draws the steps to `path`.svg and
/// `path`.png with gnuplot and returns the figures as Markdown tables. Throws core::StartupError if
/// gnuplot does not run or the files cannot be written.
std::string drawStepResponses(const config::Sim& sim, const std::string& path);

}  // namespace roundabout::sim
