#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planner/nn/weight_file.h"
#include "planner/policies/ga3c_cadrl/network.h"

// Weight files of GA3C-CADRL networks; the format is in docs/formats/weights.md.

namespace roundabout::planner {

/// With an LSTM, with weights shared by all other agents, with a maximum and with attention over
/// them.
inline constexpr std::string_view kLstmArchitecture = "ga3c_cadrl_lstm";
inline constexpr std::string_view kWeightSharingArchitecture = "ga3c_cadrl_ws";
inline constexpr std::string_view kPooledArchitecture = "ga3c_cadrl_pool";
inline constexpr std::string_view kAttentionArchitecture = "ga3c_cadrl_attention";

/// The tensors of a file. Kernels are [inputs, outputs].
std::vector<nn::TensorSpec> ga3cCadrlTensors(std::string_view architecture, int max_others);

/// What a file says of its network beside the tensors.
struct Ga3cCadrlDescription {
  std::string_view architecture = kLstmArchitecture;
  Normalisation normalisation;
  int max_others = 0;
  OthersOrder others_order = OthersOrder::kClosestLast;  ///< that it was trained with
  ValueBaseline value_baseline = ValueBaseline::kNone;
  std::optional<StallSettings> stall{};
  std::string provenance;  ///< where it comes from, how it was trained
};

std::map<std::string, std::string> ga3cCadrlMetadata(const Ga3cCadrlDescription& description);

/// Throws core::StartupError naming the tensor or the metadata key if a tensor is missing, unknown,
/// of another shape or not finite, or if the metadata does not say what this program's encoder and
/// network do. `path` stands for the file in errors.
std::shared_ptr<const Ga3cCadrlWeights> toGa3cCadrlWeights(const nn::TensorFile& tensors,
                                                           const std::string& path);

/// Reads a file. Throws as nn::readSafetensors and toGa3cCadrlWeights do.
std::shared_ptr<const Ga3cCadrlWeights> readGa3cCadrlWeights(const std::string& path);

}  // namespace roundabout::planner
