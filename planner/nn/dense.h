#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

namespace roundabout::planner::nn {

template <int kSize>
using Row = Eigen::Matrix<float, 1, kSize>;

/// [inputs, outputs], row-major, as stored in weight files. Its size is known to the compiler in
/// one direction only, because Eigen keeps fully fixed matrices inside the object.
template <int kOutputs>
using Kernel = Eigen::Matrix<float, Eigen::Dynamic, kOutputs, Eigen::RowMajor>;

/// output += input * kernel. Zero inputs cost nothing: after a ReLU that is about half of them.
/// kernel: [inputs, kOutputs], perhaps some rows of a larger one. kInputs may be Eigen::Dynamic.
template <int kInputs, int kOutputs>
void addProduct(const Row<kInputs>& input, const Eigen::Ref<const Kernel<kOutputs>>& kernel,
                Row<kOutputs>& output) {
  constexpr int kBlock = kInputs == Eigen::Dynamic ? 128 : kInputs;
  const int size = static_cast<int>(input.size());
  std::array<int, kBlock> active;
  for (int begin = 0; begin < size; begin += kBlock) {
    // Without a branch, since which inputs are zero cannot be predicted.
    int count = 0;
    for (int i = begin; i < std::min(begin + kBlock, size); ++i) {
      active[count] = i;
      count += input[i] != 0.0F ? 1 : 0;
    }
    // Four rows at a time, so that the output is loaded and stored a quarter as often.
    int k = 0;
    for (; k + 4 <= count; k += 4) {
      output += input[active[k]] * kernel.row(active[k]) +
                input[active[k + 1]] * kernel.row(active[k + 1]) +
                input[active[k + 2]] * kernel.row(active[k + 2]) +
                input[active[k + 3]] * kernel.row(active[k + 3]);
    }
    for (; k < count; ++k) {
      output += input[active[k]] * kernel.row(active[k]);
    }
  }
}

/// A fully connected layer: y = x kernel + bias. With kInputs Eigen::Dynamic the kernel says how
/// many inputs there are.
template <int kInputs, int kOutputs>
struct Dense {
  Kernel<kOutputs> kernel = Kernel<kOutputs>::Zero(std::max(kInputs, 0), kOutputs);
  Row<kOutputs> bias = Row<kOutputs>::Zero();

  void apply(const Row<kInputs>& input, Row<kOutputs>& output) const {
    output = bias;
    addProduct<kInputs, kOutputs>(input, kernel, output);
  }

  void applyRelu(const Row<kInputs>& input, Row<kOutputs>& output) const {
    apply(input, output);
    output = output.cwiseMax(0.0F);
  }
};

}  // namespace roundabout::planner::nn
