#include "learning/training/batch.h"

#include <algorithm>
#include <array>

namespace roundabout::learning {

namespace {

/// In single precision, as the planner does it.
template <std::size_t kSize>
float* normalise(const std::array<float, kSize>& fields, const std::array<double, kSize>& mean,
                 const std::array<double, kSize>& deviation, float* normalised) {
  for (std::size_t i = 0; i < kSize; ++i) {
    *normalised++ = (fields[i] - static_cast<float>(mean[i])) / static_cast<float>(deviation[i]);
  }
  return normalised;
}

void reserve(Matrix& matrix, Eigen::Index rows) {
  if (matrix.rows() < rows) {
    matrix.conservativeResize(2 * rows, Eigen::NoChange);
  }
}

}  // namespace

void Batch::clear() { first_.assign(1, 0); }

void Batch::add(const planner::EgoFeatures& ego, std::span<const planner::OtherFeatures> others) {
  constexpr const planner::Normalisation& kNormalisation = planner::kPublishedNormalisation;
  reserve(egos_, size() + 1);
  float* const own = &egos_(size(), 0);
  normalise(ego, kNormalisation.ego_mean, kNormalisation.ego_deviation, own);
  const Eigen::Index first_pair = pairCount();
  const Eigen::Index end_pair = first_pair + static_cast<Eigen::Index>(others.size());
  reserve(pairs_, end_pair);
  float* pair = pairs_.data() + first_pair * kPair;
  for (const planner::OtherFeatures& other : others) {
    pair = std::copy_n(own, planner::kEgoInputs, pair);
    pair = normalise(other, kNormalisation.other_mean, kNormalisation.other_deviation, pair);
  }
  first_.push_back(end_pair);
}

}  // namespace roundabout::learning
