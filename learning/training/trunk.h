#pragma once

#include "learning/training/dense_layer.h"

namespace roundabout::learning {

/// What all networks end with: three layers with ReLU, and the two heads.
class Trunk {
 public:
  explicit Trunk(const ParameterLayout& layout);

  Eigen::Index inputs() const { return layer1_.inputs; }
  /// joint: a row for each observation: the ego, then the summary of the others.
  const Matrix& forward(const Parameters& parameters, const Matrix& joint);
  /// Adds to `gradient`; returns that by joint. Valid until the next call.
  const Matrix& backward(const Parameters& parameters, const Matrix& joint, const Matrix& d_heads,
                         Parameters& gradient);

 private:
  void addHeadsGradient(const Matrix& d_heads, Parameters& gradient) const;

  Layer layer1_, layer2_, layer3_, policy_, value_;
  Matrix heads_kernel_, wide1_, wide2_, wide3_, heads_;
  Matrix d_joint_, d_wide1_, d_wide2_, d_wide3_;
};

}  // namespace roundabout::learning
