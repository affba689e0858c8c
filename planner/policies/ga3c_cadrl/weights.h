#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "planner/nn/weight_file.h"
#include "planner/policies/ga3c_cadrl/network.h"

// Weight files of GA3C-CADRL networks; the format is in docs/formats/weights.md.

namespace roundabout::planner {

inline constexpr std::string_view kGa3cCadrlArchitecture = "ga3c_cadrl_lstm";

/// Kernels are [inputs, outputs].
inline constexpr std::array<nn::TensorSpec, 12> kGa3cCadrlTensors = {{{"lstm/kernel", 71, 256},
                                                                      {"lstm/bias", 0, 256},
                                                                      {"layer1/kernel", 68, 256},
                                                                      {"layer1/bias", 0, 256},
                                                                      {"layer2/kernel", 256, 256},
                                                                      {"layer2/bias", 0, 256},
                                                                      {"layer3/kernel", 256, 256},
                                                                      {"layer3/bias", 0, 256},
                                                                      {"policy/kernel", 256, 11},
                                                                      {"policy/bias", 0, 11},
                                                                      {"value/kernel", 256, 1},
                                                                      {"value/bias", 0, 1}}};

/// What a file says of its network beside the tensors.
struct Ga3cCadrlDescription {
  Normalisation normalisation;
  int max_others = 0;
  OthersOrder others_order = OthersOrder::kClosestLast;  ///< that it was trained with
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
