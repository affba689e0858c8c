#pragma once

#include <cstdint>

#include "planner/nn/safetensors.h"

namespace roundabout::test {

/// A valid DRLMACA network that knows nothing, as a weight file; the same for the same seed.
planner::nn::TensorFile randomDrlMaca(std::uint64_t seed = 1);

/// One that looks at nothing but its goal: turns to it and flies.
planner::nn::TensorFile goalSeekingDrlMaca();

}  // namespace roundabout::test
