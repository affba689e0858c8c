#include "learning/training/parameters.h"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::learning {

namespace {

constexpr Eigen::Index kAlignment = 16;  // numbers in a cache line

Eigen::Index countOf(const planner::nn::TensorSpec& tensor) {
  return static_cast<Eigen::Index>(std::max(tensor.rows, 1)) * tensor.columns;
}

}  // namespace

ParameterLayout::ParameterLayout(std::vector<planner::nn::TensorSpec> tensors)
    : tensors_(std::move(tensors)) {
  for (const planner::nn::TensorSpec& tensor : tensors_) {
    begins_[std::string(tensor.name)] = size_;
    size_ += (countOf(tensor) + kAlignment - 1) / kAlignment * kAlignment;
  }
}

ParameterLayout::Layer ParameterLayout::layer(const std::string& name) const {
  const std::string kernel = name + "/kernel";
  const auto spec = std::find_if(tensors_.begin(), tensors_.end(),
                                 [&](const auto& tensor) { return tensor.name == kernel; });
  const auto bias = begins_.find(name + "/bias");
  return {begins_.at(kernel), bias == begins_.end() ? -1 : bias->second, spec->rows, spec->columns};
}

std::map<std::string, ParameterLayout::Layer, std::less<>> ParameterLayout::layers() const {
  constexpr std::string_view kKernel = "/kernel";
  std::map<std::string, Layer, std::less<>> layers;
  for (const planner::nn::TensorSpec& tensor : tensors_) {
    if (tensor.name.ends_with(kKernel)) {
      const std::string name(tensor.name.substr(0, tensor.name.size() - kKernel.size()));
      layers[name] = layer(name);
    }
  }
  return layers;
}

void ParameterLayout::write(const Parameters& parameters, const std::string& prefix,
                            planner::nn::TensorFile& file) const {
  for (const planner::nn::TensorSpec& tensor : tensors_) {
    const float* begin = parameters.data() + begins_.find(tensor.name)->second;
    file.tensors[prefix + std::string(tensor.name)] = {tensor.shape(),
                                                       {begin, begin + countOf(tensor)}};
  }
}

Parameters ParameterLayout::read(const planner::nn::TensorFile& file, const std::string& prefix,
                                 const std::string& path) const {
  Parameters parameters = Parameters::Zero(size_);
  for (const planner::nn::TensorSpec& tensor : tensors_) {
    const std::string name = prefix + std::string(tensor.name);
    const auto found = file.tensors.find(name);
    if (found == file.tensors.end() || found->second.shape != tensor.shape()) {
      throw core::StartupError(
          path, "tensor " + name, planner::nn::shapeText(tensor.shape()),
          found == file.tensors.end() ? "nothing" : planner::nn::shapeText(found->second.shape));
    }
    std::copy(found->second.values.begin(), found->second.values.end(),
              parameters.data() + begins_.find(tensor.name)->second);
  }
  return parameters;
}

}  // namespace roundabout::learning
