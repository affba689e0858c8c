#include "learning/training/trainer.h"

#include <utility>

#include "learning/training/ga3c_trainer.h"
#include "learning/training/imitation.h"
#include "learning/training/ppo_trainer.h"

namespace roundabout::learning {

TrainingState initialState(const Recipe& recipe) {
  const ParameterLayout layout = networkPlan(recipe).layout();
  TrainingState state(layout.size());
  if (recipe.begin_with.empty()) {
    core::RandomStream random(recipe.seed, "training/parameters");
    state.parameters = initialParameters(layout, random);
  } else {
    state.parameters =
        layout.read(planner::nn::readSafetensors(recipe.begin_with), "", recipe.begin_with);
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
