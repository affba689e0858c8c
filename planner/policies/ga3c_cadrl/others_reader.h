#pragma once

#include <span>
#include <variant>

#include "planner/nn/lstm.h"
#include "planner/observation.h"

namespace roundabout::planner {

inline constexpr int kOtherInputs = static_cast<int>(kOtherFields.size());
inline constexpr int kEgoInputs = static_cast<int>(kEgoFields.size());
/// Units that read one other agent.
inline constexpr int kReaderUnits = 64;
/// The same, where a maximum over the others follows, or a weighted mean.
inline constexpr int kPooledUnits = 128;
/// Weighted means side by side, each of its own part of the units.
inline constexpr int kAttentionHeads = 4;

/// The ego, normalised.
using EgoInput = nn::Row<kEgoInputs>;

/// One other agent, normalised.
using OtherInput = nn::Row<kOtherInputs>;
/// What a reader makes of all others: as many numbers for any number of them.
using Summary = Eigen::Ref<nn::Row<Eigen::Dynamic>>;

/// Reads the others one by one; the summary is the last hidden state (paper, section "Handling a
/// Variable Number of Agents").
struct RecurrentReader {
  nn::Lstm<kOtherInputs, kReaderUnits> lstm;

  void read(const EgoInput& ego, std::span<const OtherInput> others, Summary summary) const;
};

/// Reads every slot with the same layer; the summary is what comes out of all slots (the paper's
/// networks "WS", as in mit-acl/rl_collision_avoidance).
struct SharedReader {
  int slots = 0;                                         ///< room for as many others
  nn::Dense<kOtherInputs + 1, kReaderUnits> slot_layer;  ///< last input: 1 if somebody is there
  OtherInput nobody = OtherInput::Zero();                ///< stands in an empty slot

  /// Others beyond the last slot are not read.
  void read(const EgoInput& ego, std::span<const OtherInput> others, Summary summary) const;
};

/// Reads every other agent, beside the ego, with the same two layers; the summary is the maximum of
/// each unit over the others, zero without any. Their order does not matter.
struct PooledReader {
  nn::Dense<kEgoInputs + kOtherInputs, kPooledUnits> first;
  nn::Dense<kPooledUnits, kPooledUnits> second;

  void read(const EgoInput& ego, std::span<const OtherInput> others, Summary summary) const;
};

/// Reads every other agent, beside the ego, with the same two layers, as PooledReader does. Of what
/// comes out it makes contents and a score for each head; a head's summary is the mean of its part
/// of the contents, weighted by the softmax of its scores over the others (as in Chen et al. 2019,
/// "Crowd-Robot Interaction", with several heads); zero without any others.
struct AttentiveReader {
  nn::Dense<kEgoInputs + kOtherInputs, kPooledUnits> first;
  nn::Dense<kPooledUnits, kPooledUnits> second;
  nn::Kernel<kAttentionHeads> score;
  nn::Dense<kPooledUnits, kPooledUnits> content;

  void read(const EgoInput& ego, std::span<const OtherInput> others, Summary summary) const;
};

using OthersReader = std::variant<RecurrentReader, SharedReader, PooledReader, AttentiveReader>;

}  // namespace roundabout::planner
