#include "planner/policies/ga3c_cadrl/weights.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/core/error.h"

namespace roundabout::planner {

namespace {

using core::StartupError;
using nlohmann::json;

constexpr std::string_view kFormatVersion = "1";
/// More others than this in one observation is a damaged file, not a network.
constexpr int kMaxOthersLimit = 1000;
/// What two ways of writing the same angle may differ by.
constexpr double kActionTolerance = 1e-6;
/// TensorFlow adds this to the forget gate when it runs; it is not in the stored bias.
constexpr float kForgetBias = 1.0F;

json actionTable() {
  json table = json::array();
  for (const DiscreteAction& action : kActions) {
    table.push_back({action.speed_fraction, action.heading_change_rad});
  }
  return table;
}

bool sameActions(const json& found) {
  const json expected = actionTable();
  if (!found.is_array() || found.size() != expected.size()) {
    return false;
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!found[i].is_array() || found[i].size() != 2) {
      return false;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      if (!found[i][k].is_number() ||
          std::abs(found[i][k].get<double>() - expected[i][k].get<double>()) > kActionTolerance) {
        return false;
      }
    }
  }
  return true;
}

/// Checks and reads the metadata of one file.
class Metadata {
 public:
  Metadata(const nn::TensorFile& file, const std::string& path) : file_(file), path_(path) {}

  const std::string& text(const std::string& key) const {
    const auto entry = file_.metadata.find(key);
    if (entry == file_.metadata.end()) {
      fail(key, "to be there", "nothing");
    }
    return entry->second;
  }

  json parsed(const std::string& key) const {
    json value = json::parse(text(key), nullptr, false);
    if (value.is_discarded()) {
      fail(key, "JSON", quoted(text(key)));
    }
    return value;
  }

  void require(const std::string& key, std::string_view expected) const {
    if (text(key) != expected) {
      fail(key, quoted(expected), quoted(text(key)));
    }
  }

  void requireList(const std::string& key, const json& expected) const {
    if (parsed(key) != expected) {
      fail(key, expected.dump(), text(key));
    }
  }

  void requireActions(const std::string& key) const {
    if (!sameActions(parsed(key))) {
      fail(key, actionTable().dump(), text(key));
    }
  }

  int count(const std::string& key, int most) const {
    const json value = parsed(key);
    if (!value.is_number_integer() || value < 1 || value > most) {
      fail(key, fmt::format("a whole number from 1 to {}", most), quoted(text(key)));
    }
    return value.get<int>();
  }

  template <int kSize>
  nn::Row<kSize> numbers(const std::string& key, bool positive) const {
    const json value = parsed(key);
    const bool fits = value.is_array() && value.size() == kSize &&
                      std::all_of(value.begin(), value.end(), [positive](const json& each) {
                        return each.is_number() && std::isfinite(each.get<float>()) &&
                               (!positive || each.get<float>() > 0.0F);
                      });
    if (!fits) {
      fail(key, fmt::format("{} {}numbers", kSize, positive ? "positive " : ""), text(key));
    }
    nn::Row<kSize> row;
    for (int i = 0; i < kSize; ++i) {
      row[i] = value[static_cast<std::size_t>(i)].get<float>();
    }
    return row;
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& expected,
                         const std::string& found) const {
    throw StartupError(path_, "metadata " + key, expected, found);
  }

  static std::string quoted(std::string_view text) { return fmt::format("\"{}\"", text); }

  const nn::TensorFile& file_;
  const std::string& path_;
};

void checkTensor(const TensorSpec& spec, const nn::TensorFile& file, const std::string& path) {
  const std::string what = fmt::format("tensor {}", spec.name);
  const auto entry = file.tensors.find(std::string(spec.name));
  if (entry == file.tensors.end()) {
    throw StartupError(path, what, "shape " + nn::shapeText(spec.shape()), "no such tensor");
  }
  const nn::Tensor& tensor = entry->second;
  if (tensor.shape != spec.shape()) {
    throw StartupError(path, what, "shape " + nn::shapeText(spec.shape()),
                       "shape " + nn::shapeText(tensor.shape));
  }
  const auto bad = std::find_if(tensor.values.begin(), tensor.values.end(),
                                [](float value) { return !std::isfinite(value); });
  if (bad != tensor.values.end()) {
    throw StartupError(path, what, "finite numbers",
                       fmt::format("{} at {}", *bad, bad - tensor.values.begin()));
  }
}

void checkTensors(const nn::TensorFile& file, const std::string& path) {
  for (const TensorSpec& spec : kGa3cCadrlTensors) {
    checkTensor(spec, file, path);
  }
  for (const auto& [name, tensor] : file.tensors) {
    const std::string& found = name;
    if (std::none_of(kGa3cCadrlTensors.begin(), kGa3cCadrlTensors.end(),
                     [&found](const TensorSpec& spec) { return spec.name == found; })) {
      throw StartupError(path, "tensor " + name,
                         "only tensors of " + std::string(kGa3cCadrlArchitecture),
                         nn::shapeText(tensor.shape));
    }
  }
}

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A checked tensor as a matrix; a vector is a matrix of one row.
Eigen::Map<const Matrix> matrix(const nn::TensorFile& file, const std::string& name) {
  const nn::Tensor& tensor = file.tensors.at(name);
  const std::int64_t rows = tensor.shape.size() == 2 ? tensor.shape[0] : 1;
  return {tensor.values.data(), rows, tensor.shape.back()};
}

template <int kInputs, int kOutputs>
void fill(nn::Dense<kInputs, kOutputs>& layer, const nn::TensorFile& file,
          const std::string& name) {
  layer.kernel = matrix(file, name + "/kernel");
  layer.bias = matrix(file, name + "/bias");
}

}  // namespace

std::vector<std::int64_t> TensorSpec::shape() const {
  return rows == 0 ? std::vector<std::int64_t>{columns} : std::vector<std::int64_t>{rows, columns};
}

std::map<std::string, std::string> ga3cCadrlMetadata(const Normalisation& normalisation,
                                                     int max_others,
                                                     const std::string& provenance) {
  return {{"architecture", std::string(kGa3cCadrlArchitecture)},
          {"format_version", std::string(kFormatVersion)},
          {"ego_fields", json(kEgoFields).dump()},
          {"ego_mean", json(normalisation.ego_mean).dump()},
          {"ego_deviation", json(normalisation.ego_deviation).dump()},
          {"other_fields", json(kOtherFields).dump()},
          {"other_mean", json(normalisation.other_mean).dump()},
          {"other_deviation", json(normalisation.other_deviation).dump()},
          {"others_order", std::string(ObservationEncoder::kOrder)},
          {"max_others", std::to_string(max_others)},
          {"actions", actionTable().dump()},
          {"provenance", provenance}};
}

std::shared_ptr<const Ga3cCadrlWeights> toGa3cCadrlWeights(const nn::TensorFile& file,
                                                           const std::string& path) {
  using Weights = Ga3cCadrlWeights;
  const Metadata metadata(file, path);
  metadata.require("architecture", kGa3cCadrlArchitecture);
  metadata.require("format_version", kFormatVersion);
  metadata.requireList("ego_fields", kEgoFields);
  metadata.requireList("other_fields", kOtherFields);
  metadata.require("others_order", ObservationEncoder::kOrder);
  metadata.requireActions("actions");
  metadata.text("provenance");
  checkTensors(file, path);

  auto weights = std::make_shared<Weights>();
  weights->ego_mean = metadata.numbers<Weights::kEgoInputs>("ego_mean", false);
  weights->ego_deviation = metadata.numbers<Weights::kEgoInputs>("ego_deviation", true);
  weights->other_mean = metadata.numbers<Weights::kOtherInputs>("other_mean", false);
  weights->other_deviation = metadata.numbers<Weights::kOtherInputs>("other_deviation", true);
  weights->max_others = metadata.count("max_others", kMaxOthersLimit);

  const auto lstm_kernel = matrix(file, "lstm/kernel");
  weights->lstm.input_kernel = lstm_kernel.topRows<Weights::kOtherInputs>();
  weights->lstm.hidden_kernel = lstm_kernel.bottomRows<Weights::kUnits>();
  weights->lstm.bias = matrix(file, "lstm/bias");
  weights->lstm.bias.segment<Weights::kUnits>(2 * Weights::kUnits).array() += kForgetBias;
  fill(weights->layer1, file, "layer1");
  fill(weights->layer2, file, "layer2");
  fill(weights->layer3, file, "layer3");
  weights->heads.kernel << matrix(file, "policy/kernel"), matrix(file, "value/kernel");
  weights->heads.bias << matrix(file, "policy/bias"), matrix(file, "value/bias");
  return weights;
}

std::shared_ptr<const Ga3cCadrlWeights> readGa3cCadrlWeights(const std::string& path) {
  return toGa3cCadrlWeights(nn::readSafetensors(path), path);
}

}  // namespace roundabout::planner
