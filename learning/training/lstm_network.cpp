#include "learning/training/lstm_network.h"

namespace roundabout::learning {

namespace {

using planner::kEgoInputs;
using planner::kOtherInputs;
using planner::kReaderUnits;

constexpr float kForgetBias = 1.0F;  // as the planner's loader

using Units = Eigen::Array<float, 1, kReaderUnits>;

Eigen::Map<Units> block(Matrix& matrix, Eigen::Index row, int which) {
  return Eigen::Map<Units>(matrix.row(row).data() + which * kReaderUnits);
}

}  // namespace

LstmNetwork::LstmNetwork(const ParameterLayout& layout)
    : kernel_(layout.layer("lstm").kernel), bias_(layout.layer("lstm").bias), trunk_(layout) {}

void LstmNetwork::recur(const Parameters& parameters) {
  const ConstKernel from_inputs(parameters.data() + kernel_, kOtherInputs, kGates);
  const ConstKernel from_hidden(from_inputs.data() + from_inputs.size(), kUnits, kGates);
  const Eigen::Map<const Eigen::RowVectorXf> bias(parameters.data() + bias_, kGates);
  const Eigen::Index rows = inputs_.rows();
  gates_.resize(rows, kGates);
  gates_.noalias() = inputs_ * from_inputs;
  cell_.resize(rows, kUnits);
  cell_tanh_.resize(rows, kUnits);
  hidden_.resize(rows, kUnits);
  for (std::size_t t = 0; t < sorted_.reading().size(); ++t) {
    const Eigen::Index begin = sorted_.beginOfStep(t);
    const Eigen::Index before = t > 0 ? sorted_.beginOfStep(t - 1) : 0;
    const Eigen::Index reading = sorted_.readingAt(t);
    if (t > 0) {
      gates_.middleRows(begin, reading).noalias() +=
          hidden_.middleRows(before, reading) * from_hidden;
    }
    for (Eigen::Index k = 0; k < reading; ++k) {
      const Eigen::Index row = begin + k;
      gates_.row(row) += bias;
      auto input = block(gates_, row, 0);
      auto candidate = block(gates_, row, 1);
      auto forget = block(gates_, row, 2);
      auto output = block(gates_, row, 3);
      input = input.logistic();
      candidate = candidate.tanh();
      forget = (forget + kForgetBias).logistic();
      output = output.logistic();
      auto cell = block(cell_, row, 0);
      cell = input * candidate;
      if (t > 0) {
        cell += forget * block(cell_, before + k, 0);
      }
      block(cell_tanh_, row, 0) = cell.tanh();
      block(hidden_, row, 0) = output * block(cell_tanh_, row, 0);
    }
  }
}

const Matrix& LstmNetwork::forward(const Parameters& parameters, const Batch& batch) {
  sorted_.sort(batch);
  inputs_ = sorted_.byStep(batch);
  recur(parameters);
  joint_.resize(batch.size(), kEgoInputs + kUnits);
  joint_.leftCols<kEgoInputs>() = batch.egos();
  joint_.rightCols<kUnits>().setZero();
  for (std::size_t t = 0; t < sorted_.reading().size(); ++t) {
    for (Eigen::Index k = sorted_.readingAt(t + 1); k < sorted_.readingAt(t); ++k) {
      joint_.row(sorted_.observation(k)).rightCols<kUnits>() =
          hidden_.row(sorted_.beginOfStep(t) + k);
    }
  }
  return trunk_.forward(parameters, joint_);
}

void LstmNetwork::recurBack(const Parameters& parameters, const Matrix& d_joint,
                            Parameters& gradient) {
  const ConstKernel from_hidden(parameters.data() + kernel_ + kOtherInputs * kGates, kUnits,
                                kGates);
  Eigen::Map<Matrix> d_from_hidden(gradient.data() + kernel_ + kOtherInputs * kGates, kUnits,
                                   kGates);
  d_gates_.resize(inputs_.rows(), kGates);
  d_hidden_.resize(sorted_.size(), kUnits);
  d_cell_.resize(sorted_.size(), kUnits);
  for (std::size_t t = sorted_.reading().size(); t-- > 0;) {
    const Eigen::Index begin = sorted_.beginOfStep(t);
    const Eigen::Index before = t > 0 ? sorted_.beginOfStep(t - 1) : 0;
    const Eigen::Index reading = sorted_.readingAt(t);
    const Eigen::Index go_on = sorted_.readingAt(t + 1);
    if (go_on > 0) {
      d_hidden_.topRows(go_on).noalias() =
          d_gates_.middleRows(sorted_.beginOfStep(t + 1), go_on) * from_hidden.transpose();
    }
    for (Eigen::Index k = go_on; k < reading; ++k) {
      d_hidden_.row(k) = d_joint.row(sorted_.observation(k)).rightCols<kUnits>();
      d_cell_.row(k).setZero();
    }
    for (Eigen::Index k = 0; k < reading; ++k) {
      const Eigen::Index row = begin + k;
      const Units input = block(gates_, row, 0);
      const Units candidate = block(gates_, row, 1);
      const Units forget = block(gates_, row, 2);
      const Units output = block(gates_, row, 3);
      const Units tanh = block(cell_tanh_, row, 0);
      const Units d_hidden = block(d_hidden_, k, 0);
      auto d_cell = block(d_cell_, k, 0);
      d_cell += d_hidden * output * (1.0F - tanh * tanh);
      block(d_gates_, row, 0) = d_cell * candidate * input * (1.0F - input);
      block(d_gates_, row, 1) = d_cell * input * (1.0F - candidate * candidate);
      block(d_gates_, row, 3) = d_hidden * tanh * output * (1.0F - output);
      if (t > 0) {
        block(d_gates_, row, 2) = d_cell * block(cell_, before + k, 0) * forget * (1.0F - forget);
      } else {
        block(d_gates_, row, 2).setZero();
      }
      d_cell *= forget;
    }
    if (t > 0) {
      d_from_hidden.noalias() +=
          hidden_.middleRows(before, reading).transpose() * d_gates_.middleRows(begin, reading);
    }
  }
  Eigen::Map<Matrix>(gradient.data() + kernel_, kOtherInputs, kGates).noalias() +=
      inputs_.transpose() * d_gates_;
  Eigen::Map<Eigen::RowVectorXf>(gradient.data() + bias_, kGates) += d_gates_.colwise().sum();
}

void LstmNetwork::backward(const Parameters& parameters, const Batch&, const Matrix& d_heads,
                           Parameters& gradient) {
  recurBack(parameters, trunk_.backward(parameters, joint_, d_heads, gradient), gradient);
}

}  // namespace roundabout::learning
