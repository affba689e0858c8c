#include "planner/policies/ga3c_cadrl/weights.h"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

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

/// A file without the key has the first.
constexpr std::array kValueBaselines = {
    std::pair(std::string_view("none"), ValueBaseline::kNone),
    std::pair(std::string_view("lone_agent"), ValueBaseline::kLoneAgent),
};

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

std::optional<StallSettings> stallSettings(const nn::WeightFile& file, const std::string& key) {
  if (file.findText(key) == nullptr) {
    return std::nullopt;
  }
  const std::vector<float> numbers = file.numbers(key, 3, true);
  if (!(numbers[0] >= 1.0F && numbers[0] <= 1e6F) || numbers[0] != std::floor(numbers[0])) {
    file.failMetadata(key, "a whole number of decisions first", file.text(key));
  }
  return StallSettings{static_cast<int>(numbers[0]), numbers[1], numbers[2]};
}

std::string_view knownArchitecture(const nn::WeightFile& file) {
  const std::string& found = file.text("architecture");
  constexpr std::array kKnown = {kLstmArchitecture, kWeightSharingArchitecture, kPooledArchitecture,
                                 kAttentionArchitecture};
  for (const std::string_view known : kKnown) {
    if (found == known) {
      return known;
    }
  }
  file.failMetadata("architecture", fmt::format("one of {}", fmt::join(kKnown, ", ")),
                    fmt::format("\"{}\"", found));
}

ValueBaseline valueBaseline(const nn::WeightFile& file, const std::string& key) {
  const std::string* name = file.findText(key);
  for (const auto& [known, baseline] : kValueBaselines) {
    if (name == nullptr || *name == known) {
      return baseline;
    }
  }
  file.failMetadata(key, "none or lone_agent", fmt::format("\"{}\"", *name));
}

RecurrentReader recurrentReader(const nn::WeightFile& file) {
  RecurrentReader reader;
  const auto kernel = file.matrix("lstm/kernel");
  reader.lstm.input_kernel = kernel.topRows<kOtherInputs>();
  reader.lstm.hidden_kernel = kernel.bottomRows<kReaderUnits>();
  reader.lstm.bias = file.matrix("lstm/bias");
  reader.lstm.bias.segment<kReaderUnits>(2 * kReaderUnits).array() += kForgetBias;
  return reader;
}

SharedReader sharedReader(const nn::WeightFile& file, const Ga3cCadrlWeights& weights) {
  SharedReader reader;
  reader.slots = weights.max_others;
  file.fill(reader.slot_layer, "other");
  // The published code fills empty slots with zeros before it normalises.
  reader.nobody = (-weights.other_mean).cwiseQuotient(weights.other_deviation);
  return reader;
}

PooledReader pooledReader(const nn::WeightFile& file) {
  PooledReader reader;
  file.fill(reader.first, "other1");
  file.fill(reader.second, "other2");
  return reader;
}

AttentiveReader attentiveReader(const nn::WeightFile& file) {
  AttentiveReader reader;
  file.fill(reader.first, "other1");
  file.fill(reader.second, "other2");
  file.fill(reader.content, "content");
  reader.score = file.matrix("score/kernel");
  return reader;
}

}  // namespace

std::vector<nn::TensorSpec> ga3cCadrlTensors(std::string_view architecture, int max_others) {
  constexpr int kWidth = Ga3cCadrlWeights::kWidth;
  const bool shared = architecture == kWeightSharingArchitecture;
  const bool attentive = architecture == kAttentionArchitecture;
  const bool pooled = architecture == kPooledArchitecture || attentive;
  const int summary = pooled ? kPooledUnits : kReaderUnits * (shared ? max_others : 1);
  std::vector<nn::TensorSpec> tensors = {
      {"layer1/kernel", Ga3cCadrlWeights::kEgoInputs + summary, kWidth},
      {"layer1/bias", 0, kWidth},
      {"layer2/kernel", kWidth, kWidth},
      {"layer2/bias", 0, kWidth},
      {"layer3/kernel", kWidth, kWidth},
      {"layer3/bias", 0, kWidth},
      {"policy/kernel", kWidth, Ga3cCadrlWeights::kActionCount},
      {"policy/bias", 0, Ga3cCadrlWeights::kActionCount},
      {"value/kernel", kWidth, 1},
      {"value/bias", 0, 1}};
  if (shared) {
    tensors.push_back({"other/kernel", kOtherInputs + 1, kReaderUnits});
    tensors.push_back({"other/bias", 0, kReaderUnits});
  } else if (pooled) {
    tensors.push_back({"other1/kernel", kEgoInputs + kOtherInputs, kPooledUnits});
    tensors.push_back({"other1/bias", 0, kPooledUnits});
    tensors.push_back({"other2/kernel", kPooledUnits, kPooledUnits});
    tensors.push_back({"other2/bias", 0, kPooledUnits});
  }
  if (attentive) {
    tensors.push_back({"content/kernel", kPooledUnits, kPooledUnits});
    tensors.push_back({"content/bias", 0, kPooledUnits});
    tensors.push_back({"score/kernel", kPooledUnits, kAttentionHeads});
  }
  if (!shared && !pooled) {
    tensors.push_back({"lstm/kernel", kOtherInputs + kReaderUnits, 4 * kReaderUnits});
    tensors.push_back({"lstm/bias", 0, 4 * kReaderUnits});
  }
  return tensors;
}

std::map<std::string, std::string> ga3cCadrlMetadata(const Ga3cCadrlDescription& description) {
  const Normalisation& normalisation = description.normalisation;
  std::map<std::string, std::string> metadata = {
      {"architecture", std::string(description.architecture)},
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
      {"value_baseline",
       std::string(kValueBaselines[static_cast<std::size_t>(description.value_baseline)].first)},
      {"provenance", description.provenance}};
  if (description.stall) {
    const StallSettings& stall = *description.stall;
    metadata["stall"] = json({stall.decisions, stall.progress_m, stall.sharpness}).dump();
  }
  return metadata;
}

std::shared_ptr<const Ga3cCadrlWeights> toGa3cCadrlWeights(const nn::TensorFile& tensors,
                                                           const std::string& path) {
  using Weights = Ga3cCadrlWeights;
  const nn::WeightFile file(tensors, path);
  const std::string_view architecture = knownArchitecture(file);
  file.require("format_version", kFormatVersion);
  file.requireJson("ego_fields", kEgoFields);
  file.requireJson("other_fields", kOtherFields);
  requireActions(file, "actions");
  file.text("provenance");
  const int max_others = file.count("max_others", kMaxOthersLimit);
  file.requireTensors(ga3cCadrlTensors(architecture, max_others), architecture);

  auto weights = std::make_shared<Weights>();
  weights->ego_mean = file.row<Weights::kEgoInputs>("ego_mean");
  weights->ego_deviation = file.row<Weights::kEgoInputs>("ego_deviation", true);
  weights->other_mean = file.row<kOtherInputs>("other_mean");
  weights->other_deviation = file.row<kOtherInputs>("other_deviation", true);
  weights->max_others = max_others;
  weights->others_order = othersOrder(file, "others_order");
  weights->value_baseline = valueBaseline(file, "value_baseline");
  weights->stall = stallSettings(file, "stall");

  if (architecture == kWeightSharingArchitecture) {
    weights->others = sharedReader(file, *weights);
  } else if (architecture == kPooledArchitecture) {
    weights->others = pooledReader(file);
  } else if (architecture == kAttentionArchitecture) {
    weights->others = attentiveReader(file);
  } else {
    weights->others = recurrentReader(file);
  }
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
