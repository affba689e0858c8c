#include "learning/training/sorted_batch.h"

#include <algorithm>

namespace roundabout::learning {

using planner::kOtherInputs;

Eigen::RowVectorXf emptySlot() {
  constexpr const planner::Normalisation& kNormalisation = planner::kPublishedNormalisation;
  Eigen::RowVectorXf fields(kOtherInputs + 1);
  for (std::size_t i = 0; i < kNormalisation.other_mean.size(); ++i) {
    fields[static_cast<Eigen::Index>(i)] = -static_cast<float>(kNormalisation.other_mean[i]) /
                                           static_cast<float>(kNormalisation.other_deviation[i]);
  }
  fields[kOtherInputs] = 0.0F;
  return fields;
}

void SortedBatch::sort(const Batch& batch) {
  const auto others = [&](Eigen::Index b) { return batch.first(b + 1) - batch.first(b); };
  std::vector<Eigen::Index> counts;  // observations with k others
  for (Eigen::Index b = 0; b < batch.size(); ++b) {
    const auto k = static_cast<std::size_t>(others(b));
    counts.resize(std::max(counts.size(), k + 1), 0);
    ++counts[k];
  }
  groups_.clear();
  std::vector<Eigen::Index> place(counts.size());
  Eigen::Index first = 0;
  Eigen::Index first_pair = 0;
  for (std::size_t k = counts.size(); k-- > 0;) {
    place[k] = first;
    const auto each = static_cast<Eigen::Index>(k);
    if (counts[k] > 0) {
      groups_.push_back({first, counts[k], each, first_pair});
    }
    first += counts[k];
    first_pair += counts[k] * each;
  }
  reading_.assign(place.empty() ? 0 : place.size() - 1, 0);
  std::copy(place.begin(), place.begin() + static_cast<std::ptrdiff_t>(reading_.size()),
            reading_.begin());  // those with more than k others come before those with k
  begin_of_step_.clear();
  Eigen::Index begin = 0;
  for (const Eigen::Index count : reading_) {
    begin_of_step_.push_back(begin);
    begin += count;
  }
  sorted_.resize(static_cast<std::size_t>(batch.size()));
  for (Eigen::Index b = 0; b < batch.size(); ++b) {
    sorted_[static_cast<std::size_t>(place[static_cast<std::size_t>(others(b))]++)] = b;
  }
}

Matrix SortedBatch::egos(const Batch& batch) const {
  Matrix egos(size(), planner::kEgoInputs);
  for (Eigen::Index place = 0; place < size(); ++place) {
    egos.row(place) = batch.egos().row(observation(place));
  }
  return egos;
}

Matrix SortedBatch::byStep(const Batch& batch) const {
  Matrix fields(batch.pairCount(), kOtherInputs);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < reading_.size(); ++k) {
    for (Eigen::Index place = 0; place < reading_[k]; ++place, ++row) {
      const Eigen::Index pair = batch.first(observation(place)) + static_cast<Eigen::Index>(k);
      fields.row(row) = batch.pairs().row(pair).rightCols<kOtherInputs>();
    }
  }
  return fields;
}

Matrix SortedBatch::pairs(const Batch& batch) const {
  Matrix pairs(batch.pairCount(), Batch::kPair);
  Eigen::Index row = 0;
  for (const Eigen::Index b : sorted_) {
    const Eigen::Index count = batch.first(b + 1) - batch.first(b);
    pairs.middleRows(row, count) = batch.pairs().middleRows(batch.first(b), count);
    row += count;
  }
  return pairs;
}

Matrix SortedBatch::slots(const Batch& batch, int slots) const {
  Matrix fields = emptySlot().replicate(size() * slots, 1);
  for (Eigen::Index place = 0; place < size(); ++place) {
    const Eigen::Index b = observation(place);
    const Eigen::Index count = std::min<Eigen::Index>(batch.first(b + 1) - batch.first(b), slots);
    auto filled = fields.middleRows(place * slots, count);
    filled.leftCols<kOtherInputs>() =
        batch.pairs().middleRows(batch.first(b), count).rightCols<kOtherInputs>();
    filled.rightCols<1>().setOnes();
  }
  return fields;
}

}  // namespace roundabout::learning
