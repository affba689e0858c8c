#pragma once

#include <string>

#include "planner/nn/safetensors.h"
#include "planner/others_order.h"

namespace roundabout::planner {

/// The published GA3C-CADRL network of a TensorFlow V2 checkpoint (mit-acl/cadrl_ros,
/// mit-acl/gym-collision-avoidance), as this project's weight file. `prefix` is the checkpoint's
/// path without ".index". A checkpoint does not say in which order its network is to be fed; the
/// published ones were trained closest last. Throws core::StartupError if the checkpoint is damaged
/// or holds another network.
nn::TensorFile importCheckpoint(const std::string& prefix,
                                OthersOrder others_order = OthersOrder::kClosestLast);

}  // namespace roundabout::planner
