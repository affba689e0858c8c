#include "planner/policies/drl_maca/weights.h"

#include <nlohmann/json.hpp>

#include "planner/policies/drl_maca/scan_stack.h"

namespace roundabout::planner {

namespace {

using nlohmann::json;

constexpr std::string_view kFormatVersion = "1";
constexpr std::array kOwnFields = {"goal_forward", "goal_left", "linear_speed", "angular_speed"};

void fill(DrlMacaTrunk& trunk, const nn::WeightFile& file, const std::string& name) {
  trunk.conv1.kernel = file.matrix(name + "/conv1/kernel");
  trunk.conv1.bias = file.matrix(name + "/conv1/bias");
  trunk.conv2.kernel = file.matrix(name + "/conv2/kernel");
  trunk.conv2.bias = file.matrix(name + "/conv2/bias");
  file.fill(trunk.dense1, name + "/dense1");
  file.fill(trunk.dense2, name + "/dense2");
  trunk.prepare();
}

}  // namespace

std::map<std::string, std::string> drlMacaMetadata(const std::string& provenance) {
  return {{"architecture", std::string(kDrlMacaArchitecture)},
          {"format_version", std::string(kFormatVersion)},
          {"own_fields", json(kOwnFields).dump()},
          {"scans", json(DrlMacaTrunk::kScans).dump()},
          {"beams", json(DrlMacaTrunk::kBeams).dump()},
          {"field_of_view_rad", json(kDrlMacaFieldOfViewRad).dump()},
          {"max_range_m", json(kDrlMacaMaxRangeM).dump()},
          {"provenance", provenance}};
}

std::shared_ptr<const DrlMacaWeights> toDrlMacaWeights(const nn::TensorFile& tensors,
                                                       const std::string& path) {
  const nn::WeightFile file(tensors, path);
  file.require("architecture", kDrlMacaArchitecture);
  file.require("format_version", kFormatVersion);
  file.requireJson("own_fields", kOwnFields);
  file.requireJson("scans", DrlMacaTrunk::kScans);
  file.requireJson("beams", DrlMacaTrunk::kBeams);
  file.requireJson("field_of_view_rad", kDrlMacaFieldOfViewRad);
  file.requireJson("max_range_m", kDrlMacaMaxRangeM);
  file.text("provenance");
  file.requireTensors(kDrlMacaTensors, kDrlMacaArchitecture);

  auto weights = std::make_shared<DrlMacaWeights>();
  fill(weights->actor, file, "actor");
  fill(weights->critic, file, "critic");
  weights->actor_kernel << file.matrix("actor/linear/kernel"), file.matrix("actor/angular/kernel");
  weights->actor_bias << file.matrix("actor/linear/bias"), file.matrix("actor/angular/bias");
  weights->critic_kernel = file.matrix("critic/value/kernel").transpose();
  weights->critic_bias = file.matrix("critic/value/bias")(0);
  return weights;
}

std::shared_ptr<const DrlMacaWeights> readDrlMacaWeights(const std::string& path) {
  return toDrlMacaWeights(nn::readSafetensors(path), path);
}

}  // namespace roundabout::planner
