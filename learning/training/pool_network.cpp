#include "learning/training/pool_network.h"

#include <cmath>

#include "learning/training/scores.h"

namespace roundabout::learning {

namespace {

using Layer = ParameterLayout::Layer;
using ConstKernel = Eigen::Map<const Matrix>;
using ConstBias = Eigen::Map<const Eigen::RowVectorXf>;

ConstKernel kernel(const Parameters& parameters, const Layer& layer) {
  return {parameters.data() + layer.kernel, layer.inputs, layer.outputs};
}

ConstBias bias(const Parameters& parameters, const Layer& layer) {
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
void maskRelu(const Matrix& output, Matrix& d_output) {
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

void propagate(const Parameters& parameters, const Layer& layer, const Matrix& d_output,
               Matrix& d_input) {
  d_input.resize(d_output.rows(), layer.inputs);
  d_input.noalias() = d_output * kernel(parameters, layer).transpose();
}

}  // namespace

PoolNetwork::PoolNetwork(const ParameterLayout& layout)
    : other1_(layout.layer("other1")),
      other2_(layout.layer("other2")),
      layer1_(layout.layer("layer1")),
      layer2_(layout.layer("layer2")),
      layer3_(layout.layer("layer3")),
      policy_(layout.layer("policy")),
      value_(layout.layer("value")) {}

Parameters PoolNetwork::initialise(const ParameterLayout& layout, core::RandomStream& random) {
  Parameters parameters = Parameters::Zero(layout.size());
  const auto fill = [&](const char* name, double scale) {
    const Layer layer = layout.layer(name);
    const double deviation = scale * std::sqrt(2.0 / static_cast<double>(layer.inputs));
    for (Eigen::Index i = 0; i < layer.inputs * layer.outputs; ++i) {
      parameters[layer.kernel + i] = static_cast<float>(random.normal(deviation));
    }
  };
  for (const char* name : {"other1", "other2", "layer1", "layer2", "layer3"}) {
    fill(name, 1.0);
  }
  fill("policy", 0.01);
  fill("value", 0.1);
  return parameters;
}

const Matrix& PoolNetwork::forward(const Parameters& parameters, const Batch& batch) {
  applyRelu(parameters, other1_, batch.pairs(), hidden_);
  applyRelu(parameters, other2_, hidden_, read_);
  pool(batch);
  applyRelu(parameters, layer1_, joint_, wide1_);
  applyRelu(parameters, layer2_, wide1_, wide2_);
  applyRelu(parameters, layer3_, wide2_, wide3_);

  heads_kernel_.resize(policy_.inputs, kHeads);
  heads_kernel_ << kernel(parameters, policy_), kernel(parameters, value_);
  heads_.resize(batch.size(), kHeads);
  heads_.noalias() = wide3_ * heads_kernel_;
  heads_.leftCols(kActionCount).rowwise() += bias(parameters, policy_);
  heads_.rightCols(1).rowwise() += bias(parameters, value_);
  return heads_;
}

void PoolNetwork::pool(const Batch& batch) {
  const Eigen::Index units = other2_.outputs;
  joint_.resize(batch.size(), planner::kEgoInputs + units);
  winner_.resize(batch.size(), units);
  joint_.leftCols(planner::kEgoInputs) = batch.egos();
  for (Eigen::Index b = 0; b < batch.size(); ++b) {
    float* best = joint_.row(b).data() + planner::kEgoInputs;
    std::int32_t* winner = winner_.row(b).data();
    std::fill_n(best, units, 0.0F);
    std::fill_n(winner, units, -1);
    for (Eigen::Index pair = batch.first(b); pair < batch.first(b + 1); ++pair) {
      const float* read = read_.row(pair).data();
      const auto number = static_cast<std::int32_t>(pair);
      for (Eigen::Index unit = 0; unit < units; ++unit) {
        const bool larger = read[unit] > best[unit];
        best[unit] = larger ? read[unit] : best[unit];
        winner[unit] = larger ? number : winner[unit];
      }
    }
  }
}

void PoolNetwork::unpool(const Batch& batch) {
  const Eigen::Index units = other2_.outputs;
  d_read_.setZero(batch.pairCount(), units);
  for (Eigen::Index b = 0; b < batch.size(); ++b) {
    const float* d_best = d_joint_.row(b).data() + planner::kEgoInputs;
    const std::int32_t* winner = winner_.row(b).data();
    for (Eigen::Index unit = 0; unit < units; ++unit) {
      if (winner[unit] >= 0) {
        d_read_(winner[unit], unit) = d_best[unit];
      }
    }
  }
}

void PoolNetwork::backward(const Parameters& parameters, const Batch& batch, const Matrix& d_heads,
                           Parameters& gradient) {
  // The heads' gradients lie in two places.
  const Matrix d_kernel = wide3_.transpose() * d_heads;
  const Eigen::RowVectorXf d_bias = d_heads.colwise().sum();
  Eigen::Map<Matrix>(gradient.data() + policy_.kernel, policy_.inputs, kActionCount) +=
      d_kernel.leftCols(kActionCount);
  Eigen::Map<Matrix>(gradient.data() + value_.kernel, value_.inputs, 1) += d_kernel.rightCols(1);
  Eigen::Map<Eigen::RowVectorXf>(gradient.data() + policy_.bias, kActionCount) +=
      d_bias.head(kActionCount);
  gradient[value_.bias] += d_bias[kActionCount];

  d_wide3_.resize(batch.size(), policy_.inputs);
  d_wide3_.noalias() = d_heads * heads_kernel_.transpose();
  maskRelu(wide3_, d_wide3_);
  addGradient(layer3_, wide2_, d_wide3_, gradient);
  propagate(parameters, layer3_, d_wide3_, d_wide2_);
  maskRelu(wide2_, d_wide2_);
  addGradient(layer2_, wide1_, d_wide2_, gradient);
  propagate(parameters, layer2_, d_wide2_, d_wide1_);
  maskRelu(wide1_, d_wide1_);
  addGradient(layer1_, joint_, d_wide1_, gradient);
  propagate(parameters, layer1_, d_wide1_, d_joint_);

  unpool(batch);
  addGradient(other2_, hidden_, d_read_, gradient);
  propagate(parameters, other2_, d_read_, d_hidden_);
  maskRelu(hidden_, d_hidden_);
  addGradient(other1_, batch.pairs(), d_hidden_, gradient);
}

}  // namespace roundabout::learning
