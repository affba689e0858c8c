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

  /// Places [begin, end) of relu(conv(input)), into `output` from its row begin + padding_after on.
  void applyRelu(const Input& input, Output& output, int padding_after = 0, int begin = 0,
                 int end = kOutputLength) const {
    // Neighbouring patches overlap in memory: a matrix whose rows begin kStride places apart.
    using Patches = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, kPatch, Eigen::RowMajor>,
                               0, Eigen::OuterStride<>>;
    const Patches patches(input.row(kStride * begin).data(), end - begin, kPatch,
                          Eigen::OuterStride<>(kStride * kInputs));
    auto rows = output.middleRows(begin + padding_after, end - begin);
    rows.noalias() = patches * kernel;
    rows = (rows.rowwise() + bias).cwiseMax(0.0F);
  }
};

}  // namespace roundabout::planner::nn
