#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace roundabout::planner::nn {

/// Row-major float32 numbers.
struct Tensor {
  std::vector<std::int64_t> shape;
  std::vector<float> values;
};

/// What a safetensors file holds (format: docs/formats/weights.md).
struct TensorFile {
  std::map<std::string, std::string> metadata;
  std::map<std::string, Tensor> tensors;
};

/// Reads a safetensors file whose tensors are F32, or F64, which is rounded. Throws
/// core::StartupError naming the tensor if the file is missing or truncated, its header is no JSON
/// or too large, or a tensor's type, shape or place does not fit: the tensors have to fill the data
/// without overlap, gap or rest.
TensorFile readSafetensors(const std::string& path);

/// Writes `file` to `path`, whole or not at all. Throws core::StartupError if it cannot.
void writeSafetensors(const std::string& path, const TensorFile& file);

/// "[68, 256]".
std::string shapeText(const std::vector<std::int64_t>& shape);

}  // namespace roundabout::planner::nn
