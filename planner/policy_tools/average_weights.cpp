#include "planner/policy_tools/average_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::planner {

namespace {

using core::StartupError;

/// What may differ between states of one training.
constexpr std::array kHistory{"provenance", "recipe", "validation"};

constexpr double kLeastAlike = 0.5;

std::map<std::string, std::string> meaningOf(const nn::TensorFile& file) {
  std::map<std::string, std::string> meaning = file.metadata;
  for (const char* key : kHistory) {
    meaning.erase(key);
  }
  return meaning;
}

void expectSameMeaning(const nn::TensorFile& file, const nn::TensorFile& first,
                       const std::string& path, const std::string& first_path) {
  const auto expected = meaningOf(first);
  const auto found = meaningOf(file);
  for (const auto& [key, value] : expected) {
    const auto place = found.find(key);
    if (place == found.end() || place->second != value) {
      throw StartupError(path, key, value + " as in " + first_path,
                         place == found.end() ? "none" : place->second);
    }
  }
  for (const auto& [key, value] : found) {
    if (!expected.contains(key)) {
      throw StartupError(path, key, "none, as in " + first_path, value);
    }
  }
}

void add(const nn::TensorFile& file, const std::string& path, nn::TensorFile& sum) {
  for (auto& [name, total] : sum.tensors) {
    const auto tensor = file.tensors.find(name);
    if (tensor == file.tensors.end() || tensor->second.shape != total.shape) {
      throw StartupError(
          path, name, nn::shapeText(total.shape) + " as in the first file",
          tensor == file.tensors.end() ? "none" : nn::shapeText(tensor->second.shape));
    }
    std::transform(total.values.begin(), total.values.end(), tensor->second.values.begin(),
                   total.values.begin(), [](float a, float b) { return a + b; });
  }
  for (const auto& [name, tensor] : file.tensors) {
    if (!sum.tensors.contains(name)) {
      throw StartupError(path, name, "no such tensor, as in the first file",
                         nn::shapeText(tensor.shape));
    }
  }
}

/// Cosine of the angle between all weights of two networks. States of one training are at more than
/// 0.9, networks of different trainings near 0: the mean of such knows nothing.
double alikeness(const nn::TensorFile& a, const nn::TensorFile& b) {
  double product = 0.0;
  double square_a = 0.0;
  double square_b = 0.0;
  for (const auto& [name, tensor] : a.tensors) {
    const std::vector<float>& others = b.tensors.at(name).values;
    for (std::size_t i = 0; i < tensor.values.size(); ++i) {
      const double x = tensor.values[i];
      const double y = others[i];
      product += x * y;
      square_a += x * x;
      square_b += y * y;
    }
  }
  return product / std::sqrt(square_a * square_b);
}

std::string provenanceOf(const nn::TensorFile& file) {
  const auto said = file.metadata.find("provenance");
  return said == file.metadata.end() ? "unknown" : said->second;
}

}  // namespace

nn::TensorFile averageWeights(const std::vector<std::string>& paths) {
  if (paths.size() < 2) {
    throw StartupError("policy average", "FILE", "two or more", std::to_string(paths.size()));
  }
  const nn::TensorFile first = nn::readSafetensors(paths[0]);
  nn::TensorFile mean = first;
  std::string provenance = fmt::format("mean of {} networks: {}", paths.size(), provenanceOf(mean));
  std::string last_recipe;
  for (std::size_t i = 1; i < paths.size(); ++i) {
    const nn::TensorFile file = nn::readSafetensors(paths[i]);
    expectSameMeaning(file, first, paths[i], paths[0]);
    add(file, paths[i], mean);
    if (const double cosine = alikeness(first, file); !(cosine >= kLeastAlike)) {
      throw StartupError(paths[i], "weights",
                         "those of another state of the training of " + paths[0],
                         fmt::format("a network of its own (cosine {:.2f})", cosine));
    }
    provenance += "; " + provenanceOf(file);
    last_recipe = file.metadata.contains("recipe") ? file.metadata.at("recipe") : "";
  }
  mean.metadata["recipe"] = last_recipe;
  const auto count = static_cast<float>(paths.size());
  for (auto& [name, tensor] : mean.tensors) {
    for (float& value : tensor.values) {
      value /= count;
    }
  }
  mean.metadata["provenance"] = provenance;
  mean.metadata.erase("validation");
  return mean;
}

}  // namespace roundabout::planner
