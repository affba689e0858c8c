#pragma once

#include <cstdint>

#include "planner/nn/safetensors.h"

namespace roundabout::test {

/// A valid SA-CADRL network that knows nothing, as a weight file; the same for the same seed.
planner::nn::TensorFile randomCadrl(std::uint64_t seed = 1);

/// The same network laid out as the published ones are.
planner::nn::TensorFile randomPublishedCadrl(std::uint64_t seed = 1);

}  // namespace roundabout::test
