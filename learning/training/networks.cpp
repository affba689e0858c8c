#include "learning/training/networks.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "learning/training/lstm_network.h"
#include "learning/training/pool_network.h"
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

/// With shared weights the first joint layer sees the agent itself beside some hundred inputs of
/// slots, most of them empty. The agent's own part begins as large as it is beside one reader of
/// all others, the slots share the rest: else a network of many slots takes millions of agent-steps
/// to notice where its goal is.
void balanceSlots(const ParameterLayout& layout, Parameters& parameters) {
  const ParameterLayout::Layer joint = layout.layer("layer1");
  const Eigen::Index slot = layout.layer("other").outputs;
  const auto slots = static_cast<float>((joint.inputs - planner::kEgoInputs) / slot);
  const auto grown =
      std::sqrt(static_cast<float>(joint.inputs) / static_cast<float>(planner::kEgoInputs + slot));
  const Eigen::Index own = planner::kEgoInputs * joint.outputs;
  parameters.segment(joint.kernel, own) *= grown;
  parameters.segment(joint.kernel + own, joint.inputs * joint.outputs - own) *=
      grown / std::sqrt(slots);
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
