#include "learning/training/trainer.h"

#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "learning/training/run_folder.h"
#include "learning/training/training_figure.h"
#include "tests/learning/training/small_recipe.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

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
  std::optional<RunFolder> folder(RunFolder::create(scratch / "run", test::smallRecipe()));
  Trainer whole(test::smallRecipe(), 1);
  iterate(whole, 4);
  whole.renewEnvironments();
  folder->saveCheckpoint(whole, {10.0, 5.0});
  iterate(whole, 4);

  folder.reset();
  RunFolder again = RunFolder::open(scratch / "run");
  RunFolder::Checkpoint checkpoint = again.loadCheckpoint(whole.layout());
  EXPECT_EQ(checkpoint.expense.cpu_s, 5.0);
  Trainer resumed(again.recipe(), 1, std::move(checkpoint.state));
  iterate(resumed, 4);
  EXPECT_EQ(whole.state().parameters, resumed.state().parameters);
  EXPECT_EQ(whole.state().averaged, resumed.state().averaged);
  EXPECT_EQ(whole.state().agent_steps, resumed.state().agent_steps);
}

TEST(RunFolder, IsForOneAtATime) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "run";
  RunFolder folder = RunFolder::create(path, test::smallRecipe());
  folder.saveCheckpoint(Trainer(test::smallRecipe(), 1), {});
  EXPECT_THAT(test::startupErrorOf([&] { RunFolder::open(path); }),
              testing::HasSubstr("a folder that nobody else trains in"));
}

TEST(TrainingFigure, BandIsMeanAndDeviationOfRunsAtTheSameEpisodes) {
  const LearningBand band = bandOf({{{100.0, 300.0}, {0.0, 1.0}}, {{0.0, 200.0}, {0.5, 0.5}}});
  EXPECT_DOUBLE_EQ(band.episodes.back(), 200.0);
  EXPECT_NEAR(band.mean.back(), 0.5, 1e-12);
  EXPECT_NEAR(band.deviation.back(), 0.0, 1e-12);
  EXPECT_NEAR(band.mean.front(), 0.25, 1e-12);
  EXPECT_NEAR(band.deviation.front(), 0.5 / std::sqrt(2.0), 1e-12);
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
