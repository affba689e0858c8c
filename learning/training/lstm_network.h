#pragma once

#include "learning/training/sorted_batch.h"
#include "learning/training/trainable_network.h"
#include "learning/training/trunk.h"

namespace roundabout::learning {

/// The network of planner::RecurrentReader, to be trained. By hand: no tape, no padding.
class LstmNetwork final : public TrainableNetwork {
 public:
  explicit LstmNetwork(const ParameterLayout& layout);

  const Matrix& forward(const Parameters& parameters, const Batch& batch) override;
  void backward(const Parameters& parameters, const Batch& batch, const Matrix& d_heads,
                Parameters& gradient) override;

 private:
  static constexpr int kUnits = planner::kReaderUnits;
  static constexpr int kGates = 4 * kUnits;

  void recur(const Parameters& parameters);
  void recurBack(const Parameters& parameters, const Matrix& d_joint, Parameters& gradient);

  Eigen::Index kernel_ = 0;  // where it begins among the parameters: inputs' rows, then the units'
  Eigen::Index bias_ = 0;
  Trunk trunk_;
  SortedBatch sorted_;
  // Rows are those of SortedBatch::byStep().
  Matrix inputs_;
  Matrix gates_;  // after sigmoid and tanh: input, candidate, forget, output
  Matrix cell_, cell_tanh_, hidden_;
  Matrix d_gates_;
  Matrix d_hidden_, d_cell_;  // a row for each place
  Matrix joint_;              // a row for each observation
};

}  // namespace roundabout::learning
