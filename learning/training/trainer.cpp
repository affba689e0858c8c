#include "learning/training/trainer.h"

#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "learning/training/ga3c_trainer.h"
#include "learning/training/imitation.h"
#include "learning/training/ppo_trainer.h"
#include "learning/training/weight_files.h"

namespace roundabout::learning {

namespace {

/// Throws core::StartupError unless a network means by its inputs and outputs what this plan does.
void expectTheSameKind(const planner::nn::TensorFile& file, const ParameterLayout& layout,
                       const NetworkPlan& plan, const std::string& path) {
  const planner::nn::TensorFile ours = weightFile(plan, Parameters::Zero(layout.size()), "");
  for (const char* key : {"architecture", "others_order", "value_baseline"}) {
    const auto wanted = ours.metadata.find(key);
    const auto found = file.metadata.find(key);
    const std::string has = found == file.metadata.end() ? "none" : found->second;
    if (wanted != ours.metadata.end() && has != wanted->second) {
      throw core::StartupError(path, key, wanted->second + ", as the recipe says", has);
    }
  }
}

}  // namespace

void Trainer::expectFinite(double gradient_norm) const {
  if (!std::isfinite(gradient_norm)) {
    throw core::StartupError("train", "gradient",
                             "finite numbers (the last checkpoint holds some: --resume, or another "
                             "recipe)",
                             fmt::format("others after {} agent-steps", state_.agent_steps));
  }
}

TrainingState initialState(const Recipe& recipe) {
  const ParameterLayout layout = networkPlan(recipe).layout();
  TrainingState state(layout.size());
  if (recipe.begin_with.empty()) {
    core::RandomStream random(recipe.seed, "training/parameters");
    state.parameters = initialParameters(layout, random);
  } else {
    const planner::nn::TensorFile file = planner::nn::readSafetensors(recipe.begin_with);
    expectTheSameKind(file, layout, networkPlan(recipe), recipe.begin_with);
    state.parameters = layout.read(file, "", recipe.begin_with);
  }
  if (recipe.imitation.updates > 0) {
    imitate(recipe, gatherDemonstrations(recipe), state.parameters);
  }
  state.averaged = state.parameters;
  return state;
}

Trainer::Trainer(const Recipe& recipe, TrainingState state)
    : recipe_(recipe),
      plan_(networkPlan(recipe)),
      layout_(plan_.layout()),
      state_(std::move(state)) {}

std::unique_ptr<Trainer> makeTrainer(const Recipe& recipe, int threads, TrainingState state) {
  if (recipe.algorithm == "ga3c") {
    return std::make_unique<Ga3cTrainer>(recipe, threads, std::move(state));
  }
  return std::make_unique<PpoTrainer>(recipe, threads, std::move(state));
}

}  // namespace roundabout::learning
