#pragma once

#include "planner/nn/dense.h"

namespace roundabout::planner::nn {

/// A one-dimensional convolution over kLength places of kInputs channels; beyond the ends there are
/// kPadding places of zeros. Its kernel is that of a dense layer from the kWidth places a filter
/// covers, one after the other with all their channels: row tap * kInputs + channel.
template <int kLength, int kInputs, int kOutputs, int kWidth, int kStride, int kPadding>
struct Conv1d {
  static constexpr int kOutputLength = (kLength + 2 * kPadding - kWidth) / kStride + 1;
  static constexpr int kPatch = kWidth * kInputs;

  /// [places with padding, channels]; whoever fills it leaves the padding zero.
  using Input = Eigen::Matrix<float, Eigen::Dynamic, kInputs, Eigen::RowMajor>;
  using Output = Eigen::Matrix<float, Eigen::Dynamic, kOutputs, Eigen::RowMajor>;

  Kernel<kOutputs> kernel = Kernel<kOutputs>::Zero(kPatch, kOutputs);
  Row<kOutputs> bias = Row<kOutputs>::Zero();

  static Input makeInput() { return Input::Zero(kLength + 2 * kPadding, kInputs); }
  /// With room for the padding of the layer after it.
  static Output makeOutput(int padding_after = 0) {
    return Output::Zero(kOutputLength + 2 * padding_after, kOutputs);
  }

  /// relu(conv(input)) from row first_row of `output` on.
  void applyRelu(const Input& input, Output& output, int first_row = 0) const {
    // Neighbouring patches overlap in memory: a matrix whose rows begin kStride places apart.
    using Patches = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, kPatch, Eigen::RowMajor>,
                               0, Eigen::OuterStride<>>;
    const Patches patches(input.data(), kOutputLength, kPatch,
                          Eigen::OuterStride<>(kStride * kInputs));
    auto rows = output.middleRows(first_row, kOutputLength);
    rows.noalias() = patches * kernel;
    rows = (rows.rowwise() + bias).cwiseMax(0.0F);
  }
};

}  // namespace roundabout::planner::nn
