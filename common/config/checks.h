#pragma once

#include <functional>
#include <string>

#include "common/config/experiment.h"

namespace roundabout::config {

/// Told of the first contradiction between keys; does not return.
using Refuse = std::function<void(const std::string& path, const std::string& expected,
                                  const std::string& found)>;

/// Gives points that were written as [x, y] (z is NaN) the height at which the vehicles fly.
void fillHeights(Experiment& experiment, const Refuse& refuse);

/// Checks what one key alone cannot tell: double names, places outside the room, starts too
/// close to each other, limits in the wrong order, steps that do not fit. What a formation must
/// keep to is fleet's to check.
void checkConsistency(const Experiment& experiment, const Refuse& refuse);

}  // namespace roundabout::config
