#include "planner/policy_tools/import_checkpoint.h"

#include <array>
#include <filesystem>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/policy_tools/checkpoint.h"

namespace roundabout::planner {

namespace {

/// The published networks' own, which their graphs apply and their variables do not hold. 3.14 is
/// what they have, not pi.
constexpr int kPublishedMaxOthers = 19;

struct Renamed {
  std::string_view published;
  std::string_view ours;
};

constexpr std::array<Renamed, 12> kTensors = {{{"rnn/lstm_cell/kernel:0", "lstm/kernel"},
                                               {"rnn/lstm_cell/bias:0", "lstm/bias"},
                                               {"layer1/kernel:0", "layer1/kernel"},
                                               {"layer1/bias:0", "layer1/bias"},
                                               {"layer2/kernel:0", "layer2/kernel"},
                                               {"layer2/bias:0", "layer2/bias"},
                                               {"fullyconnected1/kernel:0", "layer3/kernel"},
                                               {"fullyconnected1/bias:0", "layer3/bias"},
                                               {"logits_p/kernel:0", "policy/kernel"},
                                               {"logits_p/bias:0", "policy/bias"},
                                               {"logits_v/kernel:0", "value/kernel"},
                                               {"logits_v/bias:0", "value/bias"}}};

}  // namespace

nn::TensorFile importCheckpoint(const std::string& prefix, OthersOrder others_order) {
  const Checkpoint checkpoint(prefix);
  nn::TensorFile file;
  for (const Renamed& tensor : kTensors) {
    file.tensors.emplace(tensor.ours, checkpoint.readFloats(std::string(tensor.published)));
  }
  const std::filesystem::path path = std::filesystem::absolute(prefix);
  file.metadata = ga3cCadrlMetadata(
      {.normalisation = kPublishedNormalisation,
       .max_others = kPublishedMaxOthers,
       .others_order = others_order,
       .provenance = fmt::format("imported from the TensorFlow checkpoint {}/{}, training step {}",
                                 path.parent_path().filename().string(), path.filename().string(),
                                 checkpoint.readInt("step:0"))});
  toGa3cCadrlWeights(file, prefix);
  return file;
}

}  // namespace roundabout::planner
