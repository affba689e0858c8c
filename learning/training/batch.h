#pragma once

#include <span>
#include <vector>

#include "learning/training/matrix.h"
#include "planner/policies/ga3c_cadrl/network.h"

namespace roundabout::learning {

/// Observations, normalised, as networks read them in one go.
class Batch {
 public:
  static constexpr int kPair = planner::kEgoInputs + planner::kOtherInputs;

  void clear();
  void add(const planner::EgoFeatures& ego, std::span<const planner::OtherFeatures> others);

  Eigen::Index size() const { return static_cast<Eigen::Index>(first_.size()) - 1; }
  Eigen::Index pairCount() const { return first_.back(); }
  /// One row for each observation.
  auto egos() const { return egos_.topRows(size()); }
  /// One row for each other agent of each observation: the ego, then the other.
  auto pairs() const { return pairs_.topRows(pairCount()); }
  /// The pairs of observation i are first(i) to first(i + 1).
  Eigen::Index first(Eigen::Index observation) const {
    return first_[static_cast<std::size_t>(observation)];
  }

 private:
  Matrix egos_ = Matrix::Zero(256, planner::kEgoInputs);
  Matrix pairs_ = Matrix::Zero(1024, kPair);
  std::vector<Eigen::Index> first_{0};
};

}  // namespace roundabout::learning
