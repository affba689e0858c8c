#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "planner/nn/lstm.h"

namespace roundabout::planner::nn {
namespace {

constexpr double kTolerance = 1e-5;

template <class Matrix>
void randomise(Matrix& matrix, core::RandomStream& random, double deviation) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    matrix.data()[i] = static_cast<float>(random.normal(deviation));
  }
}

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

// x kernel + bias in the order and precision of a textbook.
template <int kOutputs, class Input>
std::vector<double> product(const Input& input, const Kernel<kOutputs>& kernel,
                            const Row<kOutputs>& bias) {
  std::vector<double> output(kOutputs);
  for (int j = 0; j < kOutputs; ++j) {
    output[j] = bias[j];
    for (int i = 0; i < static_cast<int>(input.size()); ++i) {
      output[j] += double{input[i]} * double{kernel(i, j)};
    }
  }
  return output;
}

TEST(Dense, EqualsTheTextbookFormulaWhateverInputsAreZero) {
  core::RandomStream random(1, "dense");
  Dense<37, 12> layer;
  randomise(layer.kernel, random, 1.0);
  randomise(layer.bias, random, 1.0);
  // From none to all active, so that every remainder of a group of four occurs.
  for (int active = 0; active <= 37; ++active) {
    Row<37> input = Row<37>::Zero();
    for (int i = 0; i < active; ++i) {
      input[(i * 11) % 37] = static_cast<float>(random.normal(1.0));
    }
    Row<12> output;
    layer.apply(input, output);
    const std::vector<double> expected = product<12>(input, layer.kernel, layer.bias);
    for (int j = 0; j < 12; ++j) {
      EXPECT_NEAR(output[j], expected[j], kTolerance) << active << " active, output " << j;
    }
  }
}

TEST(Dense, TakesAsManyInputsAsItsKernelHas) {
  core::RandomStream random(2, "dense");
  for (const int inputs : {1, 127, 128, 129, 300}) {
    Dense<Eigen::Dynamic, 12> layer;
    layer.kernel.resize(inputs, 12);
    randomise(layer.kernel, random, 0.1);
    randomise(layer.bias, random, 1.0);
    Row<Eigen::Dynamic> input(inputs);
    randomise(input, random, 1.0);
    Row<12> output;
    layer.apply(input, output);
    const std::vector<double> expected = product<12>(input, layer.kernel, layer.bias);
    for (int j = 0; j < 12; ++j) {
      EXPECT_NEAR(output[j], expected[j], kTolerance) << inputs << " inputs, output " << j;
    }
  }
}

TEST(Dense, ReluReplacesNegativeOutputsByZero) {
  Dense<1, 3> layer;
  layer.kernel << 2.0F, -2.0F, 0.0F;
  layer.bias << 0.5F, 0.5F, -0.0F;
  Row<3> output;
  layer.applyRelu(Row<1>(1.0F), output);
  EXPECT_EQ(output, Row<3>(2.5F, 0.0F, 0.0F));
}

TEST(Lstm, EqualsTheTextbookFormulaOverManySteps) {
  constexpr int kInputs = 3;
  constexpr int kUnits = 8;
  core::RandomStream random(2, "lstm");
  Lstm<kInputs, kUnits> lstm;
  randomise(lstm.input_kernel, random, 1.0);
  randomise(lstm.hidden_kernel, random, 0.5);
  randomise(lstm.bias, random, 0.5);

  LstmState<kUnits> state;
  std::vector<double> hidden(kUnits, 0.0);
  std::vector<double> cell(kUnits, 0.0);
  for (int step = 0; step < 50; ++step) {
    Row<kInputs> input;
    randomise(input, random, 2.0);
    lstm.step(input, state);

    std::vector<double> gates = product<4 * kUnits>(input, lstm.input_kernel, lstm.bias);
    for (int j = 0; j < 4 * kUnits; ++j) {
      for (int k = 0; k < kUnits; ++k) {
        gates[j] += hidden[k] * double{lstm.hidden_kernel(k, j)};
      }
    }
    for (int k = 0; k < kUnits; ++k) {
      cell[k] = sigmoid(gates[2 * kUnits + k]) * cell[k] +
                sigmoid(gates[k]) * std::tanh(gates[kUnits + k]);
      hidden[k] = sigmoid(gates[3 * kUnits + k]) * std::tanh(cell[k]);
      EXPECT_NEAR(state.cell[k], cell[k], kTolerance) << "step " << step << ", unit " << k;
      EXPECT_NEAR(state.hidden[k], hidden[k], kTolerance) << "step " << step << ", unit " << k;
    }
  }
}

TEST(Lstm, StaysFiniteWhenItsGatesSaturate) {
  Lstm<1, 4> lstm;
  lstm.input_kernel.setConstant(1000.0F);
  LstmState<4> state;
  for (const float input : {1.0F, -1.0F, 1.0F}) {
    lstm.step(Row<1>(input), state);
    EXPECT_TRUE(state.hidden.allFinite());
    EXPECT_LE(state.hidden.cwiseAbs().maxCoeff(), 1.0F);
  }
}

}  // namespace
}  // namespace roundabout::planner::nn
