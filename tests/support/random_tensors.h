#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "common/core/random.h"
#include "planner/nn/weight_file.h"

namespace roundabout::test {

/// Tensors that know nothing, the same for the same seed. Sums over a kernel's inputs come out near
/// one, so that no unit saturates.
inline planner::nn::TensorFile randomTensors(std::span<const planner::nn::TensorSpec> specs,
                                             std::uint64_t seed) {
  planner::nn::TensorFile file;
  for (const planner::nn::TensorSpec& spec : specs) {
    core::RandomStream random(seed, spec.name);
    const double deviation = spec.rows == 0 ? 0.1 : 1.5 / std::sqrt(spec.rows);
    planner::nn::Tensor tensor;
    tensor.shape = spec.shape();
    tensor.values.resize(static_cast<std::size_t>(std::max(spec.rows, 1)) *
                         static_cast<std::size_t>(spec.columns));
    for (float& value : tensor.values) {
      value = static_cast<float>(random.normal(deviation));
    }
    file.tensors.emplace(spec.name, std::move(tensor));
  }
  return file;
}

}  // namespace roundabout::test
