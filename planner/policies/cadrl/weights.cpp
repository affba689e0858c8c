#include "planner/policies/cadrl/weights.h"

#include <nlohmann/json.hpp>

#include "planner/policies/cadrl/published.h"

namespace roundabout::planner {

namespace {

using nlohmann::json;

constexpr std::string_view kFormatVersion = "1";
constexpr std::string_view kOthersOrder = "closest_first";

template <int kOwn, int kOther, int kUnits>
void fill(SharedLayer<kOwn, kOther, kUnits>& layer, const nn::WeightFile& file,
          const std::string& name) {
  const auto tensor = [&](const char* part) { return file.matrix(name + "/" + part); };
  layer.joint << tensor("own_from_own"), tensor("other_from_own"), tensor("own_from_other"),
      tensor("other_from_other");
  layer.self = tensor("other_from_self") - tensor("other_from_other");
  layer.bias << tensor("own_bias"), tensor("other_bias");
}

}  // namespace

std::map<std::string, std::string> cadrlMetadata(const CadrlNormalisation& normalisation,
                                                 const std::string& provenance) {
  return {{"architecture", std::string(kCadrlArchitecture)},
          {"format_version", std::string(kFormatVersion)},
          {"own_fields", json(kCadrlOwnFields).dump()},
          {"own_mean", json(normalisation.own_mean).dump()},
          {"own_deviation", json(normalisation.own_deviation).dump()},
          {"other_fields", json(kCadrlOtherFields).dump()},
          {"other_mean", json(normalisation.other_mean).dump()},
          {"other_deviation", json(normalisation.other_deviation).dump()},
          {"others_order", std::string(kOthersOrder)},
          {"max_others", std::to_string(kCadrlOthers)},
          {"value_mean", json(std::array{normalisation.value_mean}).dump()},
          {"value_deviation", json(std::array{normalisation.value_deviation}).dump()},
          {"provenance", provenance}};
}

std::shared_ptr<const CadrlWeights> toCadrlWeights(const nn::TensorFile& tensors,
                                                   const std::string& path) {
  using Weights = CadrlWeights;
  const nn::WeightFile file(tensors, path);
  file.require("architecture", kCadrlArchitecture);
  file.require("format_version", kFormatVersion);
  file.requireJson("own_fields", kCadrlOwnFields);
  file.requireJson("other_fields", kCadrlOtherFields);
  file.require("others_order", kOthersOrder);
  file.requireJson("max_others", kCadrlOthers);
  file.text("provenance");
  file.requireTensors(kCadrlTensors, kCadrlArchitecture);

  auto weights = std::make_shared<Weights>();
  weights->own_mean = file.row<Weights::kOwnInputs>("own_mean");
  weights->own_deviation = file.row<Weights::kOwnInputs>("own_deviation", true);
  weights->other_mean = file.row<Weights::kOtherInputs>("other_mean");
  weights->other_deviation = file.row<Weights::kOtherInputs>("other_deviation", true);
  weights->value_mean = file.row<1>("value_mean")[0];
  weights->value_deviation = file.row<1>("value_deviation", true)[0];
  fill(weights->layer1, file, "layer1");
  fill(weights->layer2, file, "layer2");
  file.fill(weights->layer3, "layer3");
  weights->value_kernel = file.matrix("value/kernel").transpose();
  weights->value_bias = file.matrix("value/bias")(0);
  return weights;
}

std::shared_ptr<const CadrlWeights> readCadrlWeights(const std::string& path) {
  const nn::TensorFile file = nn::readSafetensors(path);
  return toCadrlWeights(isPublishedCadrl(file) ? importPublishedCadrl(file, path) : file, path);
}

}  // namespace roundabout::planner
