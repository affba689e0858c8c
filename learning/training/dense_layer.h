#pragma once

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

/// Lets nothing through where the ReLU did not.
inline void maskRelu(const Matrix& output, Matrix& d_output) {
  d_output.array() = (output.array() > 0.0F).select(d_output.array(), 0.0F);
}

template <class Input>
void addGradient(const Layer& layer, const Input& input, const Matrix& d_output,
                 Parameters& gradient) {
  Eigen::Map<Matrix>(gradient.data() + layer.kernel, layer.inputs, layer.outputs).noalias() +=
      input.transpose() * d_output;
  Eigen::Map<Eigen::RowVectorXf>(gradient.data() + layer.bias, layer.outputs) +=
      d_output.colwise().sum();
}

inline void propagate(const Parameters& parameters, const Layer& layer, const Matrix& d_output,
                      Matrix& d_input) {
  d_input.resize(d_output.rows(), layer.inputs);
  d_input.noalias() = d_output * kernel(parameters, layer).transpose();
}

}  // namespace roundabout::learning
