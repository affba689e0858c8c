#include "learning/training/trunk.h"

#include "learning/training/scores.h"

namespace roundabout::learning {

Trunk::Trunk(const ParameterLayout& layout)
    : layer1_(layout.layer("layer1")),
      layer2_(layout.layer("layer2")),
      layer3_(layout.layer("layer3")),
      policy_(layout.layer("policy")),
      value_(layout.layer("value")) {}

const Matrix& Trunk::forward(const Parameters& parameters, const Matrix& joint) {
  applyRelu(parameters, layer1_, joint, wide1_);
  applyRelu(parameters, layer2_, wide1_, wide2_);
  applyRelu(parameters, layer3_, wide2_, wide3_);

  heads_kernel_.resize(policy_.inputs, kHeads);
  heads_kernel_ << kernel(parameters, policy_), kernel(parameters, value_);
  heads_.resize(joint.rows(), kHeads);
  heads_.noalias() = wide3_ * heads_kernel_;
  heads_.leftCols(kActionCount).rowwise() += bias(parameters, policy_);
  heads_.rightCols(1).rowwise() += bias(parameters, value_);
  return heads_;
}

// The heads' gradients lie in two places.
void Trunk::addHeadsGradient(const Matrix& d_heads, Parameters& gradient) const {
  const Matrix d_kernel = wide3_.transpose() * d_heads;
  const Eigen::RowVectorXf d_bias = d_heads.colwise().sum();
  Eigen::Map<Matrix>(gradient.data() + policy_.kernel, policy_.inputs, kActionCount) +=
      d_kernel.leftCols(kActionCount);
  Eigen::Map<Matrix>(gradient.data() + value_.kernel, value_.inputs, 1) += d_kernel.rightCols(1);
  Eigen::Map<Eigen::RowVectorXf>(gradient.data() + policy_.bias, kActionCount) +=
      d_bias.head(kActionCount);
  gradient[value_.bias] += d_bias[kActionCount];
}

const Matrix& Trunk::backward(const Parameters& parameters, const Matrix& joint,
                              const Matrix& d_heads, Parameters& gradient) {
  addHeadsGradient(d_heads, gradient);
  d_wide3_.resize(d_heads.rows(), policy_.inputs);
  d_wide3_.noalias() = d_heads * heads_kernel_.transpose();
  maskRelu(wide3_, d_wide3_);
  addGradient(layer3_, wide2_, d_wide3_, gradient);
  propagate(parameters, layer3_, d_wide3_, d_wide2_);
  maskRelu(wide2_, d_wide2_);
  addGradient(layer2_, wide1_, d_wide2_, gradient);
  propagate(parameters, layer2_, d_wide2_, d_wide1_);
  maskRelu(wide1_, d_wide1_);
  addGradient(layer1_, joint, d_wide1_, gradient);
  propagate(parameters, layer1_, d_wide1_, d_joint_);
  return d_joint_;
}

}  // namespace roundabout::learning
