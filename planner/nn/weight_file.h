#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "planner/nn/dense.h"
#include "planner/nn/safetensors.h"

namespace roundabout::planner::nn {

/// A tensor that every file of an architecture has.
struct TensorSpec {
  std::string_view name;
  int rows = 0;  ///< 0: it is a vector
  int columns = 0;

  std::vector<std::int64_t> shape() const;
};

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A weight file as its loader checks and reads it. All functions throw core::StartupError naming
/// the file, the tensor or metadata key, what was expected and what was found.
class WeightFile {
 public:
  /// `path` stands for the file in errors. Both outlive this object.
  WeightFile(const TensorFile& file, const std::string& path) : file_(file), path_(path) {}

  const std::string& text(const std::string& key) const;
  /// nullptr if it is not there.
  const std::string* findText(const std::string& key) const;
  nlohmann::json json(const std::string& key) const;
  /// A whole number from 1 to `most`.
  int count(const std::string& key, int most) const;
  /// `size` finite, perhaps positive numbers.
  std::vector<float> numbers(const std::string& key, int size, bool positive) const;
  template <int kSize>
  Row<kSize> row(const std::string& key, bool positive = false) const {
    return Eigen::Map<const Row<kSize>>(numbers(key, kSize, positive).data());
  }

  void require(const std::string& key, std::string_view expected) const;
  void requireJson(const std::string& key, const nlohmann::json& expected) const;
  /// These tensors, all finite, and no others. `architecture` is for the error.
  void requireTensors(std::span<const TensorSpec> specs, std::string_view architecture) const;

  /// A checked tensor; a vector is a matrix of one row.
  Eigen::Map<const Matrix> matrix(const std::string& name) const;
  /// NAME/kernel and NAME/bias.
  template <int kInputs, int kOutputs>
  void fill(Dense<kInputs, kOutputs>& layer, const std::string& name) const {
    layer.kernel = matrix(name + "/kernel");
    layer.bias = matrix(name + "/bias");
  }

  [[noreturn]] void failMetadata(const std::string& key, const std::string& expected,
                                 const std::string& found) const;

 private:
  void requireTensor(const TensorSpec& spec) const;

  const TensorFile& file_;
  const std::string& path_;
};

}  // namespace roundabout::planner::nn
