#pragma once

#include "learning/training/recipe.h"

namespace roundabout::test {

/// A few environments and small batches: an iteration takes milliseconds.
inline learning::Recipe smallRecipe() {
  learning::Recipe recipe;
  recipe.ppo.environments = 6;
  recipe.ppo.steps = 8;
  recipe.ppo.minibatch = 64;
  recipe.shards = 3;
  learning::Stage stage;
  stage.name = "small";
  stage.agent_steps = 1000;
  stage.max_agents = 5;
  stage.trap_share = 0.3;
  stage.sharp_share = 0.3;
  recipe.stages = {stage};
  return recipe;
}

}  // namespace roundabout::test
