#include "learning/training/pool_network.h"

#include <algorithm>
#include <array>

#include "planner/policies/ga3c_cadrl/others_reader.h"

namespace roundabout::learning {

namespace {

constexpr Eigen::Index kUnitsAtOnce = 16;
static_assert(planner::kPooledUnits % kUnitsAtOnce == 0);

}  // namespace

PoolNetwork::PoolNetwork(const ParameterLayout& layout)
    : other1_(layout.layer("other1")), other2_(layout.layer("other2")), trunk_(layout) {}

const Matrix& PoolNetwork::forward(const Parameters& parameters, const Batch& batch) {
  applyRelu(parameters, other1_, batch.pairs(), hidden_);
  applyRelu(parameters, other2_, hidden_, read_);
  pool(batch);
  return trunk_.forward(parameters, joint_);
}

// The pooling goes over a vector's width of units at a time, which stay in registers over all the
// others of an observation.
void PoolNetwork::pool(const Batch& batch) {
  const Eigen::Index units = other2_.outputs;
  joint_.resize(batch.size(), planner::kEgoInputs + units);
  winner_.resize(batch.size(), units);
  joint_.leftCols(planner::kEgoInputs) = batch.egos();
  for (Eigen::Index b = 0; b < batch.size(); ++b) {
    float* const best = joint_.row(b).data() + planner::kEgoInputs;
    std::int32_t* const winner = winner_.row(b).data();
    for (Eigen::Index unit = 0; unit < units; unit += kUnitsAtOnce) {
      std::array<float, kUnitsAtOnce> most{};
      std::array<std::int32_t, kUnitsAtOnce> whose;
      whose.fill(-1);
      for (Eigen::Index pair = batch.first(b); pair < batch.first(b + 1); ++pair) {
        const float* const read = read_.row(pair).data() + unit;
        for (std::size_t u = 0; u < kUnitsAtOnce; ++u) {
          whose[u] = read[u] > most[u] ? static_cast<std::int32_t>(pair) : whose[u];
          most[u] = read[u] > most[u] ? read[u] : most[u];
        }
      }
      std::copy(most.begin(), most.end(), best + unit);
      std::copy(whose.begin(), whose.end(), winner + unit);
    }
  }
}

void PoolNetwork::unpool(const Batch& batch, const Matrix& d_joint) {
  const Eigen::Index units = other2_.outputs;
  d_read_.resize(batch.pairCount(), units);
  for (Eigen::Index b = 0; b < batch.size(); ++b) {
    const float* const d_best = d_joint.row(b).data() + planner::kEgoInputs;
    const std::int32_t* const winner = winner_.row(b).data();
    for (Eigen::Index pair = batch.first(b); pair < batch.first(b + 1); ++pair) {
      float* const d_read = d_read_.row(pair).data();
      const auto number = static_cast<std::int32_t>(pair);
      for (Eigen::Index unit = 0; unit < units; ++unit) {
        d_read[unit] = onlyIf(winner[unit] == number, d_best[unit]);
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
