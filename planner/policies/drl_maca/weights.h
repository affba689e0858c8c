#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "planner/nn/weight_file.h"
#include "planner/policies/drl_maca/network.h"

// Weight files of DRLMACA networks; the format is in docs/formats/weights.md.

namespace roundabout::planner {

inline constexpr std::string_view kDrlMacaArchitecture = "drl_maca";

/// Kernels are [inputs, outputs].
inline constexpr std::array<nn::TensorSpec, 23> kDrlMacaTensors = {
    {{"actor/conv1/kernel", 15, 32},     {"actor/conv1/bias", 0, 32},
     {"actor/conv2/kernel", 96, 32},     {"actor/conv2/bias", 0, 32},
     {"actor/dense1/kernel", 4096, 256}, {"actor/dense1/bias", 0, 256},
     {"actor/dense2/kernel", 260, 128},  {"actor/dense2/bias", 0, 128},
     {"actor/linear/kernel", 128, 1},    {"actor/linear/bias", 0, 1},
     {"actor/angular/kernel", 128, 1},   {"actor/angular/bias", 0, 1},
     {"actor/log_deviation", 0, 2},      {"critic/conv1/kernel", 15, 32},
     {"critic/conv1/bias", 0, 32},       {"critic/conv2/kernel", 96, 32},
     {"critic/conv2/bias", 0, 32},       {"critic/dense1/kernel", 4096, 256},
     {"critic/dense1/bias", 0, 256},     {"critic/dense2/kernel", 260, 128},
     {"critic/dense2/bias", 0, 128},     {"critic/value/kernel", 128, 1},
     {"critic/value/bias", 0, 1}}};

/// What goes beside the tensors. provenance: where the network comes from, how it was trained.
std::map<std::string, std::string> drlMacaMetadata(const std::string& provenance);

/// Throws core::StartupError naming the tensor or the metadata key if a tensor is missing, unknown,
/// of another shape or not finite, or if the metadata does not say what this program does. `path`
/// stands for the file in errors.
std::shared_ptr<const DrlMacaWeights> toDrlMacaWeights(const nn::TensorFile& tensors,
                                                       const std::string& path);

/// Reads a file. Throws as nn::readSafetensors and toDrlMacaWeights do.
std::shared_ptr<const DrlMacaWeights> readDrlMacaWeights(const std::string& path);

}  // namespace roundabout::planner
