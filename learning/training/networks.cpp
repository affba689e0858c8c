#include "learning/training/networks.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "learning/training/lstm_network.h"
#include "learning/training/pool_network.h"
#include "learning/training/sorted_batch.h"
#include "learning/training/torch_library.h"
#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::learning {

NetworkPlan networkPlan(const Recipe& recipe) {
  return {"ga3c_cadrl_" + recipe.network, recipe.max_others,
          planner::othersOrderNamed(recipe.others_order).value(),
          recipe.potential ? planner::ValueBaseline::kLoneAgent : planner::ValueBaseline::kNone,
          recipe.engine == "torch"};
}

ParameterLayout NetworkPlan::layout() const {
  return ParameterLayout(planner::ga3cCadrlTensors(architecture, max_others));
}

namespace {

// With shared weights the first joint layer sees four inputs of the agent itself beside hundreds of
// slots', most of them empty. Drawn as any other layer, such a network learns to keep away from
// everybody and for millions of agent-steps does not notice where its goal is. So it begins with
// quiet slots, of which the empty ones say nothing.

/// Beside one reader of all others, whose weights are as large as the agent's own.
constexpr float kLoudness = 0.3F;

void balanceSlots(const ParameterLayout& layout, Parameters& parameters) {
  const ParameterLayout::Layer joint = layout.layer("layer1");
  const Eigen::Index slot = layout.layer("other").outputs;
  const auto slots = static_cast<float>((joint.inputs - planner::kEgoInputs) / slot);
  const auto grown =
      std::sqrt(static_cast<float>(joint.inputs) / static_cast<float>(planner::kEgoInputs + slot));
  const Eigen::Index own = planner::kEgoInputs * joint.outputs;
  parameters.segment(joint.kernel, own) *= grown;
  parameters.segment(joint.kernel + own, joint.inputs * joint.outputs - own) *=
      kLoudness * grown / std::sqrt(slots);
}

/// Below zero in every unit, whose rectifier then passes nothing on, forward or back.
void silenceEmptySlots(const ParameterLayout& layout, Parameters& parameters) {
  constexpr float kBelow = 0.1F;
  const ParameterLayout::Layer other = layout.layer("other");
  const Eigen::RowVectorXf nobody = emptySlot();
  for (Eigen::Index unit = 0; unit < other.outputs; ++unit) {
    float sum = 0.0F;
    for (Eigen::Index field = 0; field + 1 < other.inputs; ++field) {
      sum += nobody[field] * parameters[other.kernel + field * other.outputs + unit];
    }
    parameters[other.bias + unit] = -sum - kBelow;
    parameters[other.kernel + (other.inputs - 1) * other.outputs + unit] = sum + kBelow;
  }
}

}  // namespace

Parameters initialParameters(const ParameterLayout& layout, core::RandomStream& random) {
  // He et al. 2015 before a ReLU; half that variance (LeCun) before an LSTM's gates.
  constexpr std::pair<const char*, double> kLayers[] = {
      {"other1", 2.0}, {"other2", 2.0},  {"other", 2.0},  {"lstm", 1.0},
      {"layer1", 2.0}, {"content", 1.0}, {"score", 1.0},  {"layer2", 2.0},
      {"layer3", 2.0}, {"policy", 2e-4}, {"value", 0.02},
  };
  Parameters parameters = Parameters::Zero(layout.size());
  for (const auto& [name, gain] : kLayers) {
    if (!layout.has(name)) {
      continue;
    }
    const Layer layer = layout.layer(name);
    const double deviation = std::sqrt(gain / static_cast<double>(layer.inputs));
    for (Eigen::Index i = 0; i < layer.inputs * layer.outputs; ++i) {
      parameters[layer.kernel + i] = static_cast<float>(random.normal(deviation));
    }
  }
  if (layout.has("other")) {
    balanceSlots(layout, parameters);
    silenceEmptySlots(layout, parameters);
  }
  return parameters;
}

std::unique_ptr<TrainableNetwork> makeNetwork(const NetworkPlan& plan) {
  const ParameterLayout layout = plan.layout();
  if (!plan.by_torch && plan.architecture == planner::kLstmArchitecture) {
    return std::make_unique<LstmNetwork>(layout);
  }
  if (!plan.by_torch && plan.architecture == planner::kPooledArchitecture) {
    return std::make_unique<PoolNetwork>(layout);
  }
  return makeTorchNetwork({plan.architecture, plan.max_others, layout.layers()});
}

}  // namespace roundabout::learning
