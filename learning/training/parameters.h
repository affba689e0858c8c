#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "learning/training/matrix.h"
#include "planner/nn/safetensors.h"
#include "planner/nn/weight_file.h"

namespace roundabout::learning {

/// All numbers of a network, of its gradient, or of what an optimiser remembers, one after the
/// other.
using Parameters = Eigen::VectorXf;

/// Where each tensor of an architecture is among its parameters.
class ParameterLayout {
 public:
  /// Where a layer's kernel [inputs, outputs] and bias begin. A layer may have no bias: -1.
  struct Layer {
    Eigen::Index kernel = 0;
    Eigen::Index bias = 0;
    Eigen::Index inputs = 0;
    Eigen::Index outputs = 0;
  };

  explicit ParameterLayout(std::vector<planner::nn::TensorSpec> tensors);

  /// Tensors begin at multiples of 16; what lies between them is always zero.
  Eigen::Index size() const { return size_; }
  bool has(const std::string& layer) const { return begins_.contains(layer + "/kernel"); }
  /// NAME/kernel and NAME/bias.
  Layer layer(const std::string& name) const;
  /// All of them, by name.
  std::map<std::string, Layer, std::less<>> layers() const;

  /// prefix: put before the tensors' names.
  void write(const Parameters& parameters, const std::string& prefix,
             planner::nn::TensorFile& file) const;
  /// Throws core::StartupError naming path and tensor if one is missing or has another shape.
  Parameters read(const planner::nn::TensorFile& file, const std::string& prefix,
                  const std::string& path) const;

 private:
  std::vector<planner::nn::TensorSpec> tensors_;
  std::map<std::string, Eigen::Index, std::less<>> begins_;
  Eigen::Index size_ = 0;
};

}  // namespace roundabout::learning
