#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "planner/nn/safetensors.h"
#include "planner/policies/ga3c_cadrl/network.h"

// Weight files of GA3C-CADRL networks; the format is in docs/formats/weights.md.

namespace roundabout::planner {

inline constexpr std::string_view kGa3cCadrlArchitecture = "ga3c_cadrl_lstm";

/// A tensor that every file has. Kernels are [inputs, outputs].
struct TensorSpec {
  std::string_view name;
  int rows = 0;  ///< 0: it is a vector
  int columns = 0;

  std::vector<std::int64_t> shape() const;
};

inline constexpr std::array<TensorSpec, 12> kGa3cCadrlTensors = {{{"lstm/kernel", 71, 256},
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

/// What goes beside the tensors. provenance: where the network comes from, how it was trained.
std::map<std::string, std::string> ga3cCadrlMetadata(const Normalisation& normalisation,
                                                     int max_others, const std::string& provenance);

/// Throws core::StartupError naming the tensor or the metadata key if a tensor is missing, unknown,
/// of another shape or not finite, or if the metadata does not say what this program's encoder and
/// network do. `path` stands for the file in errors.
std::shared_ptr<const Ga3cCadrlWeights> toGa3cCadrlWeights(const nn::TensorFile& file,
                                                           const std::string& path);

/// Reads a file. Throws as nn::readSafetensors and toGa3cCadrlWeights do.
std::shared_ptr<const Ga3cCadrlWeights> readGa3cCadrlWeights(const std::string& path);

}  // namespace roundabout::planner
