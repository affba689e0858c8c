#include "learning/training/pool_network.h"

namespace roundabout::learning {

PoolNetwork::PoolNetwork(const ParameterLayout& layout)
    : other1_(layout.layer("other1")), other2_(layout.layer("other2")), trunk_(layout) {}

const Matrix& PoolNetwork::forward(const Parameters& parameters, const Batch& batch) {
  applyRelu(parameters, other1_, batch.pairs(), hidden_);
  applyRelu(parameters, other2_, hidden_, read_);
  pool(batch);
  return trunk_.forward(parameters, joint_);
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

void PoolNetwork::unpool(const Batch& batch, const Matrix& d_joint) {
  const Eigen::Index units = other2_.outputs;
  d_read_.setZero(batch.pairCount(), units);
  for (Eigen::Index b = 0; b < batch.size(); ++b) {
    const float* d_best = d_joint.row(b).data() + planner::kEgoInputs;
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
  unpool(batch, trunk_.backward(parameters, joint_, d_heads, gradient));
  addGradient(other2_, hidden_, d_read_, gradient);
  propagate(parameters, other2_, d_read_, d_hidden_);
  maskRelu(hidden_, d_hidden_);
  addGradient(other1_, batch.pairs(), d_hidden_, gradient);
}

}  // namespace roundabout::learning
