#include "planner/policies/ga3c_cadrl/others_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace roundabout::planner {

void RecurrentReader::read(const EgoInput&, std::span<const OtherInput> others,
                           Summary summary) const {
  nn::LstmState<kReaderUnits> state;
  for (const OtherInput& other : others) {
    lstm.step(other, state);
  }
  summary = state.hidden;
}

void SharedReader::read(const EgoInput&, std::span<const OtherInput> others,
                        Summary summary) const {
  nn::Row<kOtherInputs + 1> input;
  nn::Row<kReaderUnits> output;
  for (int slot = 0; slot < slots; ++slot) {
    const auto index = static_cast<std::size_t>(slot);
    const bool somebody = index < others.size();
    input << (somebody ? others[index] : nobody), somebody ? 1.0F : 0.0F;
    slot_layer.applyRelu(input, output);
    summary.segment<kReaderUnits>(slot * kReaderUnits) = output;
  }
}

void PooledReader::read(const EgoInput& ego, std::span<const OtherInput> others,
                        Summary summary) const {
  nn::Row<kEgoInputs + kOtherInputs> input;
  nn::Row<kPooledUnits> hidden;
  nn::Row<kPooledUnits> output;
  summary.setZero();
  for (const OtherInput& other : others) {
    input << ego, other;
    first.applyRelu(input, hidden);
    second.applyRelu(hidden, output);
    summary = summary.cwiseMax(output);
  }
}

// In one pass: what was summed is scaled down whenever a larger score turns up.
void AttentiveReader::read(const EgoInput& ego, std::span<const OtherInput> others,
                           Summary summary) const {
  constexpr int kPart = kPooledUnits / kAttentionHeads;
  nn::Row<kEgoInputs + kOtherInputs> input;
  nn::Row<kPooledUnits> hidden;
  nn::Row<kPooledUnits> output;
  nn::Row<kPooledUnits> contents;
  nn::Row<kAttentionHeads> largest =
      nn::Row<kAttentionHeads>::Constant(-std::numeric_limits<float>::infinity());
  nn::Row<kAttentionHeads> sum = nn::Row<kAttentionHeads>::Zero();
  summary.setZero();
  for (const OtherInput& other : others) {
    input << ego, other;
    first.applyRelu(input, hidden);
    second.applyRelu(hidden, output);
    content.apply(output, contents);
    nn::Row<kAttentionHeads> scores = nn::Row<kAttentionHeads>::Zero();
    nn::addProduct<kPooledUnits, kAttentionHeads>(output, score, scores);
    for (int head = 0; head < kAttentionHeads; ++head) {
      const float top = std::max(largest[head], scores[head]);
      const float fade = std::exp(largest[head] - top);
      const float weight = std::exp(scores[head] - top);
      auto part = summary.segment<kPart>(head * kPart);
      part = fade * part + weight * contents.segment<kPart>(head * kPart);
      sum[head] = fade * sum[head] + weight;
      largest[head] = top;
    }
  }
  for (int head = 0; head < kAttentionHeads && !others.empty(); ++head) {
    summary.segment<kPart>(head * kPart) /= sum[head];
  }
}

}  // namespace roundabout::planner
