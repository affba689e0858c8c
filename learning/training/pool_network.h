#pragma once

#include <vector>

#include "common/core/random.h"
#include "learning/training/batch.h"
#include "learning/training/parameters.h"

namespace roundabout::learning {

/// The network of planner::PooledReader, to be trained: a fused pass forward and back over whole
/// batches, on scratch memory of its own. One object for each thread.
class PoolNetwork {
 public:
  explicit PoolNetwork(const ParameterLayout& layout);

  /// He initialisation; the heads begin near zero, so that at first all actions are as likely.
  static Parameters initialise(const ParameterLayout& layout, core::RandomStream& random);

  /// A row for each observation: the actions' scores, then the value. Valid until the next call.
  const Matrix& forward(const Parameters& parameters, const Batch& batch);
  /// Adds to `gradient` that of sum(d_heads * heads), after forward() with the same arguments.
  void backward(const Parameters& parameters, const Batch& batch, const Matrix& d_heads,
                Parameters& gradient);

 private:
  void pool(const Batch& batch);
  void unpool(const Batch& batch);

  ParameterLayout::Layer other1_, other2_, layer1_, layer2_, layer3_, policy_, value_;
  Matrix heads_kernel_, hidden_, read_, joint_, wide1_, wide2_, wide3_, heads_;
  Matrix d_hidden_, d_read_, d_joint_, d_wide1_, d_wide2_, d_wide3_;
  /// The pair that each unit of each observation's summary comes from; -1: none.
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> winner_;
};

}  // namespace roundabout::learning
