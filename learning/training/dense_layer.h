#pragma once

#include <bit>
#include <cstdint>

#include "learning/training/parameters.h"

// Dense layers over whole batches: a row is a sample.

namespace roundabout::learning {

using Layer = ParameterLayout::Layer;
using ConstKernel = Eigen::Map<const Matrix>;
using ConstBias = Eigen::Map<const Eigen::RowVectorXf>;

inline ConstKernel kernel(const Parameters& parameters, const Layer& layer) {
  return {parameters.data() + layer.kernel, layer.inputs, layer.outputs};
}

inline ConstBias bias(const Parameters& parameters, const Layer& layer) {
  return {parameters.data() + layer.bias, layer.outputs};
}

/// output = relu(input kernel + bias)
template <class Input>
void applyRelu(const Parameters& parameters, const Layer& layer, const Input& input,
               Matrix& output) {
  output.resize(input.rows(), layer.outputs);
  output.noalias() = input * kernel(parameters, layer);
  const ConstBias offset = bias(parameters, layer);
  for (Eigen::Index row = 0; row < output.rows(); ++row) {
    output.row(row) = (output.row(row) + offset).cwiseMax(0.0F);
  }
}

/// value or, unless it is wanted, 0. A branch here keeps GCC from making a vector loop.
inline float onlyIf(bool wanted, float value) {
  const std::uint32_t mask = wanted ? ~0U : 0U;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & mask);
}

/// Lets nothing through where the ReLU did not.
inline void maskRelu(const Matrix& output, Matrix& d_output) {
  const float* const passed = output.data();
  float* const d_passed = d_output.data();
  const Eigen::Index size = d_output.size();
  for (Eigen::Index i = 0; i < size; ++i) {
    d_passed[i] = onlyIf(passed[i] > 0.0F, d_passed[i]);
  }
}

template <class Input>
void addGradient(const Layer& layer, const Input& input, const Matrix& d_output,
                 Parameters& gradient) {
  Eigen::Map<Matrix>(gradient.data() + layer.kernel, layer.inputs, layer.outputs).noalias() +=
      input.transpose() * d_output;
  // Row by row: Eigen's sum of columns strides through memory.
  Eigen::Map<Eigen::RowVectorXf> d_bias(gradient.data() + layer.bias, layer.outputs);
  for (Eigen::Index row = 0; row < d_output.rows(); ++row) {
    d_bias += d_output.row(row);
  }
}

inline void propagate(const Parameters& parameters, const Layer& layer, const Matrix& d_output,
                      Matrix& d_input) {
  d_input.resize(d_output.rows(), layer.inputs);
  d_input.noalias() = d_output * kernel(parameters, layer).transpose();
}

}  // namespace roundabout::learning
