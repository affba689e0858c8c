#pragma once

#include <string>
#include <vector>

#include "planner/nn/safetensors.h"

namespace roundabout::planner {

/// The mean of weight files of one network in several states of its training, which is often better
/// than each of them (Izmailov et al., "Averaging Weights Leads to Wider Optima and Better
/// Generalization", UAI 2018). Its provenance names what it is the mean of, its recipe is the last
/// file's. Throws core::StartupError if a file is damaged, differs from the first in anything but
/// its numbers and its history, or is of another training by its weights.
nn::TensorFile averageWeights(const std::vector<std::string>& paths);

}  // namespace roundabout::planner
