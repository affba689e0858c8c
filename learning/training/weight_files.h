#pragma once

#include <string>

#include "learning/training/parameters.h"
#include "planner/nn/safetensors.h"

namespace roundabout::learning {

/// A network in training as the planner flies it: tensors and metadata.
planner::nn::TensorFile weightFile(const ParameterLayout& layout, const Parameters& parameters,
                                   const std::string& provenance);

}  // namespace roundabout::learning
