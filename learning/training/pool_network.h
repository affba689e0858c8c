#pragma once

#include "learning/training/trainable_network.h"
#include "learning/training/trunk.h"

namespace roundabout::learning {

/// The network of planner::PooledReader, to be trained. By hand: no tape, no copies.
class PoolNetwork final : public TrainableNetwork {
 public:
  explicit PoolNetwork(const ParameterLayout& layout);

  const Matrix& forward(const Parameters& parameters, const Batch& batch) override;
  void backward(const Parameters& parameters, const Batch& batch, const Matrix& d_heads,
                Parameters& gradient) override;

 private:
  void pool(const Batch& batch);
  void unpool(const Batch& batch, const Matrix& d_joint);

  Layer other1_, other2_;
  Trunk trunk_;
  Matrix hidden_, read_, joint_, d_hidden_, d_read_;
  /// The pair that each unit of each observation's summary comes from; -1: none.
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> winner_;
};

}  // namespace roundabout::learning
