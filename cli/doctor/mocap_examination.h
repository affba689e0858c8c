#pragma once

#include <vector>

#include "cli/doctor/examination.h"
#include "common/config/experiment.h"

namespace roundabout::cli {

/// Listens to an experiment's motion-capture system, for 3 s or, where frames come, 3 s from the
/// first: whether it answers, and what mocap_bridge would say of names, units and axes. Says so of
/// a source that is none.
std::vector<Finding> examineMocap(const config::Experiment& experiment);

}  // namespace roundabout::cli
