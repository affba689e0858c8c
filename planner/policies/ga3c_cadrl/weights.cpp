#include "planner/policies/ga3c_cadrl/weights.h"

#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

namespace roundabout::planner {

namespace {

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

void requireActions(const nn::WeightFile& file, const std::string& key) {
  if (!sameActions(file.json(key))) {
    file.failMetadata(key, actionTable().dump(), file.text(key));
  }
}

OthersOrder othersOrder(const nn::WeightFile& file, const std::string& key) {
  const std::string& name = file.text(key);
  const std::optional<OthersOrder> order = othersOrderNamed(name);
  if (!order) {
    file.failMetadata(key, fmt::format("one of {}", fmt::join(othersOrderNames(), ", ")),
                      fmt::format("\"{}\"", name));
  }
  return *order;
}

}  // namespace

std::map<std::string, std::string> ga3cCadrlMetadata(const Ga3cCadrlDescription& description) {
  const Normalisation& normalisation = description.normalisation;
  return {{"architecture", std::string(kGa3cCadrlArchitecture)},
          {"format_version", std::string(kFormatVersion)},
          {"ego_fields", json(kEgoFields).dump()},
          {"ego_mean", json(normalisation.ego_mean).dump()},
          {"ego_deviation", json(normalisation.ego_deviation).dump()},
          {"other_fields", json(kOtherFields).dump()},
          {"other_mean", json(normalisation.other_mean).dump()},
          {"other_deviation", json(normalisation.other_deviation).dump()},
          {"others_order", std::string(nameOf(description.others_order))},
          {"max_others", std::to_string(description.max_others)},
          {"actions", actionTable().dump()},
          {"provenance", description.provenance}};
}

std::shared_ptr<const Ga3cCadrlWeights> toGa3cCadrlWeights(const nn::TensorFile& tensors,
                                                           const std::string& path) {
  using Weights = Ga3cCadrlWeights;
  const nn::WeightFile file(tensors, path);
  file.require("architecture", kGa3cCadrlArchitecture);
  file.require("format_version", kFormatVersion);
  file.requireJson("ego_fields", kEgoFields);
  file.requireJson("other_fields", kOtherFields);
  requireActions(file, "actions");
  file.text("provenance");
  file.requireTensors(kGa3cCadrlTensors, kGa3cCadrlArchitecture);

  auto weights = std::make_shared<Weights>();
  weights->ego_mean = file.row<Weights::kEgoInputs>("ego_mean");
  weights->ego_deviation = file.row<Weights::kEgoInputs>("ego_deviation", true);
  weights->other_mean = file.row<Weights::kOtherInputs>("other_mean");
  weights->other_deviation = file.row<Weights::kOtherInputs>("other_deviation", true);
  weights->max_others = file.count("max_others", kMaxOthersLimit);
  weights->others_order = othersOrder(file, "others_order");

  const auto lstm_kernel = file.matrix("lstm/kernel");
  weights->lstm.input_kernel = lstm_kernel.topRows<Weights::kOtherInputs>();
  weights->lstm.hidden_kernel = lstm_kernel.bottomRows<Weights::kUnits>();
  weights->lstm.bias = file.matrix("lstm/bias");
  weights->lstm.bias.segment<Weights::kUnits>(2 * Weights::kUnits).array() += kForgetBias;
  file.fill(weights->layer1, "layer1");
  file.fill(weights->layer2, "layer2");
  file.fill(weights->layer3, "layer3");
  weights->heads.kernel << file.matrix("policy/kernel"), file.matrix("value/kernel");
  weights->heads.bias << file.matrix("policy/bias"), file.matrix("value/bias");
  return weights;
}

std::shared_ptr<const Ga3cCadrlWeights> readGa3cCadrlWeights(const std::string& path) {
  return toGa3cCadrlWeights(nn::readSafetensors(path), path);
}

}  // namespace roundabout::planner
