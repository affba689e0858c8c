#include "planner/nn/weight_file.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::planner::nn {

namespace {

using core::StartupError;

std::string inQuotes(std::string_view text) { return fmt::format("\"{}\"", text); }

}  // namespace

std::vector<std::int64_t> TensorSpec::shape() const {
  return rows == 0 ? std::vector<std::int64_t>{columns} : std::vector<std::int64_t>{rows, columns};
}

void WeightFile::failMetadata(const std::string& key, const std::string& expected,
                              const std::string& found) const {
  throw StartupError(path_, "metadata " + key, expected, found);
}

const std::string* WeightFile::findText(const std::string& key) const {
  const auto entry = file_.metadata.find(key);
  return entry == file_.metadata.end() ? nullptr : &entry->second;
}

const std::string& WeightFile::text(const std::string& key) const {
  const std::string* found = findText(key);
  if (found == nullptr) {
    failMetadata(key, "to be there", "nothing");
  }
  return *found;
}

nlohmann::json WeightFile::json(const std::string& key) const {
  nlohmann::json value = nlohmann::json::parse(text(key), nullptr, false);
  if (value.is_discarded()) {
    failMetadata(key, "JSON", inQuotes(text(key)));
  }
  return value;
}

int WeightFile::count(const std::string& key, int most) const {
  const nlohmann::json value = json(key);
  if (!value.is_number_integer() || value < 1 || value > most) {
    failMetadata(key, fmt::format("a whole number from 1 to {}", most), inQuotes(text(key)));
  }
  return value.get<int>();
}

std::vector<float> WeightFile::numbers(const std::string& key, int size, bool positive) const {
  const nlohmann::json value = json(key);
  const bool fits = value.is_array() && value.size() == static_cast<std::size_t>(size) &&
                    std::all_of(value.begin(), value.end(), [positive](const nlohmann::json& each) {
                      return each.is_number() && std::isfinite(each.get<float>()) &&
                             (!positive || each.get<float>() > 0.0F);
                    });
  if (!fits) {
    failMetadata(key, fmt::format("{} {}numbers", size, positive ? "positive " : ""), text(key));
  }
  return value.get<std::vector<float>>();
}

void WeightFile::require(const std::string& key, std::string_view expected) const {
  if (text(key) != expected) {
    failMetadata(key, inQuotes(expected), inQuotes(text(key)));
  }
}

void WeightFile::requireJson(const std::string& key, const nlohmann::json& expected) const {
  if (json(key) != expected) {
    failMetadata(key, expected.dump(), text(key));
  }
}

void WeightFile::requireTensors(std::span<const TensorSpec> specs,
                                std::string_view architecture) const {
  for (const TensorSpec& spec : specs) {
    requireTensor(spec);
  }
  for (const auto& [name, tensor] : file_.tensors) {
    const std::string& found = name;
    if (std::none_of(specs.begin(), specs.end(),
                     [&found](const TensorSpec& spec) { return spec.name == found; })) {
      throw StartupError(path_, "tensor " + name, fmt::format("only tensors of {}", architecture),
                         shapeText(tensor.shape));
    }
  }
}

void WeightFile::requireTensor(const TensorSpec& spec) const {
  const std::string what = fmt::format("tensor {}", spec.name);
  const auto entry = file_.tensors.find(std::string(spec.name));
  if (entry == file_.tensors.end()) {
    throw StartupError(path_, what, "shape " + shapeText(spec.shape()), "no such tensor");
  }
  const Tensor& tensor = entry->second;
  if (tensor.shape != spec.shape()) {
    throw StartupError(path_, what, "shape " + shapeText(spec.shape()),
                       "shape " + shapeText(tensor.shape));
  }
  const auto bad = std::find_if(tensor.values.begin(), tensor.values.end(),
                                [](float value) { return !std::isfinite(value); });
  if (bad != tensor.values.end()) {
    throw StartupError(path_, what, "finite numbers",
                       fmt::format("{} at {}", *bad, bad - tensor.values.begin()));
  }
}

Eigen::Map<const Matrix> WeightFile::matrix(const std::string& name) const {
  const Tensor& tensor = file_.tensors.at(name);
  const std::int64_t rows = tensor.shape.size() == 2 ? tensor.shape[0] : 1;
  return {tensor.values.data(), rows, tensor.shape.back()};
}

}  // namespace roundabout::planner::nn
