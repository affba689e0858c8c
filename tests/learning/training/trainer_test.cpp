#include "learning/training/trainer.h"

#include <gtest/gtest.h>

#include "learning/training/run_folder.h"
#include "tests/learning/training/small_recipe.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::learning {
namespace {

void iterate(Trainer& trainer, int times) {
  for (int i = 0; i < times; ++i) {
    trainer.iterate();
  }
}

TEST(Trainer, IsTheSameWithAnyNumberOfThreads) {
  Trainer alone(test::smallRecipe(), 1);
  Trainer together(test::smallRecipe(), 3);
  iterate(alone, 6);
  iterate(together, 6);
  EXPECT_EQ(alone.state().parameters, together.state().parameters);
  EXPECT_EQ(alone.state().averaged, together.state().averaged);
  EXPECT_EQ(alone.state().agent_steps, together.state().agent_steps);
}

TEST(Trainer, DependsOnItsSeed) {
  Recipe recipe = test::smallRecipe();
  Trainer one(recipe, 1);
  recipe.seed = 2;
  Trainer other(recipe, 1);
  EXPECT_NE(one.state().parameters, other.state().parameters);
}

TEST(Trainer, ContinuesExactlyFromACheckpoint) {
  const test::ScratchFolder scratch;
  RunFolder folder = RunFolder::create(scratch / "run", test::smallRecipe());
  Trainer whole(test::smallRecipe(), 1);
  iterate(whole, 4);
  whole.renewEnvironments();
  folder.saveCheckpoint(whole, {10.0, 5.0});
  iterate(whole, 4);

  RunFolder again = RunFolder::open(scratch / "run");
  RunFolder::Checkpoint checkpoint = again.loadCheckpoint(whole.layout());
  EXPECT_EQ(checkpoint.expense.cpu_s, 5.0);
  Trainer resumed(again.recipe(), 1, std::move(checkpoint.state));
  iterate(resumed, 4);
  EXPECT_EQ(whole.state().parameters, resumed.state().parameters);
  EXPECT_EQ(whole.state().averaged, resumed.state().averaged);
  EXPECT_EQ(whole.state().agent_steps, resumed.state().agent_steps);
}

TEST(Trainer, LearnsToGoToItsGoal) {
  Recipe recipe = test::smallRecipe();
  recipe.ppo.environments = 64;
  recipe.ppo.steps = 16;
  recipe.ppo.minibatch = 512;
  recipe.stages[0].min_agents = 1;
  recipe.stages[0].max_agents = 1;
  recipe.stages[0].trap_share = 0.0;
  recipe.stages[0].agent_steps = 60'000;
  Trainer trainer(recipe, 2);
  iterate(trainer, 5);
  const double before = trainer.iterate().success;
  IterationFigures figures;
  while (trainer.state().agent_steps < 60'000) {
    figures = trainer.iterate();
  }
  EXPECT_LT(before, 0.5);
  EXPECT_GT(figures.success, 0.9);
}

}  // namespace
}  // namespace roundabout::learning
