#pragma once

#include "planner/nn/dense.h"

namespace roundabout::planner::nn {

/// What an LSTM carries from step to step.
template <int kUnits>
struct LstmState {
  Row<kUnits> hidden = Row<kUnits>::Zero();
  Row<kUnits> cell = Row<kUnits>::Zero();
};

/// An LSTM cell without peepholes or projection (TensorFlow's BasicLSTMCell). The columns of the
/// kernels and of the bias are four blocks in the order input gate i, candidate j, forget gate f,
/// output gate o. The bias includes what is added to the forget gate.
template <int kInputs, int kUnits>
struct Lstm {
  static constexpr int kGates = 4 * kUnits;

  Kernel<kGates> input_kernel = Kernel<kGates>::Zero(kInputs, kGates);
  Kernel<kGates> hidden_kernel = Kernel<kGates>::Zero(kUnits, kGates);
  Row<kGates> bias = Row<kGates>::Zero();

  /// z = x input_kernel + h hidden_kernel + bias; c = sigmoid(f) c + sigmoid(i) tanh(j);
  /// h = sigmoid(o) tanh(c).
  void step(const Row<kInputs>& input, LstmState<kUnits>& state) const {
    Row<kGates> gates = bias;
    gates.noalias() += input * input_kernel;
    gates.noalias() += state.hidden * hidden_kernel;
    const auto gate = [&gates](int block) {
      return gates.template segment<kUnits>(block * kUnits).array();
    };
    state.cell = gate(2).logistic() * state.cell.array() + gate(0).logistic() * gate(1).tanh();
    state.hidden = gate(3).logistic() * state.cell.array().tanh();
  }
};

}  // namespace roundabout::planner::nn
