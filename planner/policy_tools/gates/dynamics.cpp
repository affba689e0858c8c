#include "planner/policy_tools/gates/dynamics.h"

namespace roundabout::planner {

namespace {

using Gate = nn::Row<kReaderUnits>;

Gate opened(const Gate& sum) { return sum.array().logistic(); }

GateStep stepOf(const Gate& by_state, const Gate& by_hidden, const Gate& bias) {
  const Gate gate = opened(by_state + by_hidden + bias);
  const double state = (gate - opened(by_hidden + bias)).norm();
  const double hidden = (gate - opened(by_state + bias)).norm();
  const double own = (gate - opened(by_state + by_hidden)).norm();
  const double sum = state + hidden + own;
  GateStep step;
  step.mean = gate.mean();
  const double scale = sum > 0.0 ? step.mean / sum : 0.0;
  step.state_part = scale * state;
  step.hidden_part = scale * hidden;
  step.bias_part = scale * own;
  return step;
}

}  // namespace

std::vector<GateStep> inputGateDynamics(const RecurrentReader& reader,
                                        std::span<const OtherInput> others) {
  // The input gate is the first block of columns.
  const auto& lstm = reader.lstm;
  const Gate bias = lstm.bias.head<kReaderUnits>();
  nn::LstmState<kReaderUnits> state;
  std::vector<GateStep> steps;
  for (const OtherInput& other : others) {
    const Gate by_state = other * lstm.input_kernel.leftCols<kReaderUnits>();
    const Gate by_hidden = state.hidden * lstm.hidden_kernel.leftCols<kReaderUnits>();
    steps.push_back(stepOf(by_state, by_hidden, bias));
    lstm.step(other, state);
  }
  return steps;
}

}  // namespace roundabout::planner
