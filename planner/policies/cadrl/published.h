#pragma once

#include <string>

#include "planner/nn/safetensors.h"

namespace roundabout::planner {

/// Whether a file has the published networks' tensors (W0, b0, … of gym-collision-avoidance) and
/// does not say what it is.
bool isPublishedCadrl(const nn::TensorFile& file);

/// A published network as this project's weight file. Throws core::StartupError, `path` standing
/// for the file, if a tensor is missing or of another shape, or if the network does not treat all
/// others alike.
nn::TensorFile importPublishedCadrl(const nn::TensorFile& published, const std::string& path);

}  // namespace roundabout::planner
