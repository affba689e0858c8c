#pragma once

#include <string>

#include "learning/training/networks.h"
#include "planner/nn/safetensors.h"

namespace roundabout::learning {

/// A network in training as the planner flies it: tensors and metadata.
planner::nn::TensorFile weightFile(const NetworkPlan& plan, const Parameters& parameters,
                                   const std::string& provenance);

}  // namespace roundabout::learning
