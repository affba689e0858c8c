#pragma once

#include <vector>

#include "learning/training/batch.h"

namespace roundabout::learning {

/// What a slot of shared weights holds if there is nobody: zeros before normalisation, as in the
/// published code, and a 0.
Eigen::RowVectorXf emptySlot();

/// Observations sorted by their number of others, the most first; equals stay in their order. Then
/// those that have a k-th other are the first rows, and those with as many others lie together:
/// readers need no padding.
class SortedBatch {
 public:
  /// Observations with as many others.
  struct Group {
    Eigen::Index first = 0;  ///< of them
    Eigen::Index count = 0;
    Eigen::Index others = 0;      ///< of each
    Eigen::Index first_pair = 0;  ///< row in pairs()
  };

  void sort(const Batch& batch);
  Eigen::Index size() const { return static_cast<Eigen::Index>(sorted_.size()); }
  /// The observation in a place, as the batch numbers it.
  Eigen::Index observation(Eigen::Index place) const {
    return sorted_[static_cast<std::size_t>(place)];
  }
  const std::vector<Group>& groups() const { return groups_; }

  /// How many observations have a k-th other, k from 0.
  const std::vector<Eigen::Index>& reading() const { return reading_; }
  Eigen::Index readingAt(std::size_t k) const { return k < reading_.size() ? reading_[k] : 0; }
  /// Where the k-th others begin in byStep().
  Eigen::Index beginOfStep(std::size_t k) const { return begin_of_step_[k]; }

  /// The egos in their places.
  Matrix egos(const Batch& batch) const;
  /// The others' fields: the first of each observation, then the second of those that have one ...
  Matrix byStep(const Batch& batch) const;
  /// Ego and other of each pair; those of an observation lie together.
  Matrix pairs(const Batch& batch) const;
  /// As many rows for each observation: the others' fields and a 1; where there is none, nobody's
  /// and a 0.
  Matrix slots(const Batch& batch, int slots) const;

 private:
  std::vector<Eigen::Index> sorted_;
  std::vector<Group> groups_;
  std::vector<Eigen::Index> reading_;
  std::vector<Eigen::Index> begin_of_step_;
};

}  // namespace roundabout::learning
