#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "planner/nn/safetensors.h"
#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::test {

/// Like the published networks', with other numbers: a reader that ignores the file's is noticed.
planner::Normalisation unusualNormalisation();

/// A valid GA3C-CADRL network that knows nothing: random parameters, the same for the same seed.
planner::nn::TensorFile randomGa3cCadrl(std::uint64_t seed,
                                        std::string_view architecture = planner::kLstmArchitecture,
                                        int max_others = 19);

/// Writes it as a weight file, for tests that need one and no reference data.
void writeRandomGa3cCadrl(const std::string& path, std::uint64_t seed = 1);

}  // namespace roundabout::test
