#pragma once

#include <vector>

#include "cli/doctor/examination.h"
#include "common/config/experiment.h"

namespace roundabout::cli {

/// Listens to an experiment's motion-capture system, for 3 s at most: whether it answers, frames
/// come, and every vehicle's body is among them. Says so of a source that is none.
std::vector<Finding> examineMocap(const config::Experiment& experiment);

}  // namespace roundabout::cli
