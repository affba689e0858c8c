#include "planner/policies/ga3c_cadrl/others_reader.h"

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

}  // namespace roundabout::planner
