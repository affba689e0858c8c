#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "planner/nn/weight_file.h"
#include "planner/policies/cadrl/network.h"

// Weight files of SA-CADRL value networks; the format is in docs/formats/weights.md.

namespace roundabout::planner {

inline constexpr std::string_view kCadrlArchitecture = "sa_cadrl_value";

/// Kernels are [inputs, outputs]. NAME/A_from_B maps B's block of units to A's; "other_from_other"
/// is from each other agent to every other one.
inline constexpr std::array<nn::TensorSpec, 18> kCadrlTensors = {
    {{"layer1/own_from_own", 7, 50},
     {"layer1/own_from_other", 8, 50},
     {"layer1/other_from_own", 7, 50},
     {"layer1/other_from_self", 8, 50},
     {"layer1/other_from_other", 8, 50},
     {"layer1/own_bias", 0, 50},
     {"layer1/other_bias", 0, 50},
     {"layer2/own_from_own", 50, 50},
     {"layer2/own_from_other", 50, 50},
     {"layer2/other_from_own", 50, 50},
     {"layer2/other_from_self", 50, 50},
     {"layer2/other_from_other", 50, 50},
     {"layer2/own_bias", 0, 50},
     {"layer2/other_bias", 0, 50},
     {"layer3/kernel", 100, 50},
     {"layer3/bias", 0, 50},
     {"value/kernel", 50, 1},
     {"value/bias", 0, 1}}};

/// What is subtracted from each number, and what it is then divided by (for the value: the other
/// way round).
struct CadrlNormalisation {
  std::array<float, kCadrlOwnFields.size()> own_mean, own_deviation;
  std::array<float, kCadrlOtherFields.size()> other_mean, other_deviation;
  float value_mean, value_deviation;
};

/// What goes beside the tensors. provenance: where the network comes from, how it was trained.
std::map<std::string, std::string> cadrlMetadata(const CadrlNormalisation& normalisation,
                                                 const std::string& provenance);

/// Throws core::StartupError naming the tensor or the metadata key if a tensor is missing, unknown,
/// of another shape or not finite, or if the metadata does not say what this program does. `path`
/// stands for the file in errors.
std::shared_ptr<const CadrlWeights> toCadrlWeights(const nn::TensorFile& tensors,
                                                   const std::string& path);

/// Reads a weight file, or a published one (published.h). Throws as nn::readSafetensors,
/// importPublishedCadrl and toCadrlWeights do.
std::shared_ptr<const CadrlWeights> readCadrlWeights(const std::string& path);

}  // namespace roundabout::planner
