#pragma once

#include "learning/training/parameters.h"
#include "learning/training/recipe.h"
#include "learning/training/samples.h"

namespace roundabout::learning {

// The supervised start (paper, section "Training the Policy"): what a cooperative expert sees, does
// and is worth. The paper's expert was CADRL, and its data are gone; ours is ORCA.

/// Flies ORCA in `imitation.cases` cases of the first stage, everybody taking part. action: the
/// discrete one nearest to what the expert did; target: the discounted reward for how it ended.
Samples gatherDemonstrations(const Recipe& recipe);

/// Cross-entropy of the actions and squared error of the values, by Adam. Returns the mean loss of
/// the last tenth of the updates.
double imitate(const Recipe& recipe, const Samples& demonstrations, Parameters& parameters);

}  // namespace roundabout::learning
