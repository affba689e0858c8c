#pragma once

#include <vector>

#include "common/config/experiment.h"

namespace roundabout::sim {

/// Where every vehicle starts: its own start if it has one, else a place drawn in sim.start_area at
/// least sim.start_spacing_m from every other start, with any heading. A function of the experiment
/// and its seed (stream "start"). Throws core::StartupError if they do not fit.
std::vector<config::Start> startPlaces(const config::Experiment& experiment);

}  // namespace roundabout::sim
