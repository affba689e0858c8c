#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/observation.h"

namespace roundabout::learning {

/// What learners saw and did, one sample for each decision.
struct Samples {
  /// In place of the next sample of the same learner.
  static constexpr std::int32_t kTerminal = -1;  ///< its episode ended
  static constexpr std::int32_t kCutOff = -2;    ///< it goes on beyond these samples

  // What was seen. Those of sample s are others[first_other[s]] to others[first_other[s + 1]].
  std::vector<planner::EgoFeatures> ego;
  std::vector<std::uint32_t> first_other{0};
  std::vector<planner::OtherFeatures> others;
  // What was done.
  std::vector<std::uint8_t> action;
  std::vector<float> sharpness;        ///< the scores were multiplied by it
  std::vector<float> log_probability;  ///< of the action
  std::vector<float> value;            ///< foretold
  // What came of it.
  std::vector<float> reward;
  std::vector<std::int32_t> next;
  std::vector<float> value_beyond;  ///< where next is kCutOff
  // What is learned from it.
  std::vector<float> advantage;
  std::vector<float> target;  ///< of the value

  std::size_t size() const { return ego.size(); }
  std::span<const planner::OtherFeatures> othersOf(std::size_t sample) const {
    return std::span(others).subspan(first_other[sample],
                                     first_other[sample + 1] - first_other[sample]);
  }

  void clear();
  /// A sample of which only is known what was seen. Returns its number.
  std::size_t add(const planner::Observation& observation);
  void append(const Samples& more);
  /// Left and right exchanged: what was seen, and the action.
  void mirror(std::size_t sample);
  /// Keeps the first `count`.
  void truncate(std::size_t count);

  /// Generalised advantage estimation (Schulman et al. 2016): fills in advantage and target.
  void estimateAdvantages(double discount, double trace_decay);
};

}  // namespace roundabout::learning
