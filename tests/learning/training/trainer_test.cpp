#include "learning/training/trainer.h"

#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "learning/training/imitation.h"
#include "learning/training/run_folder.h"
#include "learning/training/training_figure.h"
#include "learning/training/weight_files.h"
#include "tests/learning/training/small_recipe.h"
#include "tests/planner/policies/random_scene.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::learning {
namespace {

std::unique_ptr<Trainer> trainerOf(const Recipe& recipe, int threads = 1) {
  return makeTrainer(recipe, threads, initialState(recipe));
}

void iterate(Trainer& trainer, int times) {
  for (int i = 0; i < times; ++i) {
    trainer.iterate();
  }
}

/// Both algorithms, and what else may depend on chance.
class ExactTraining : public testing::TestWithParam<std::string> {
 protected:
  static Recipe recipe() {
    Recipe recipe = test::smallRecipe();
    recipe.algorithm = GetParam();
    if (recipe.algorithm == "ga3c") {
      recipe.stages[0].sharp_share = 0.0;
    } else {
      recipe.ppo.mirrored_share = 0.5;
    }
    recipe.ga3c.environments = 6;
    recipe.ga3c.iteration_samples = 400;
    recipe.imitation = {.updates = 2, .batch = 50, .cases = 3};
    recipe.network = "lstm";
    return recipe;
  }
};

TEST(Training, BeginsWithNoNetworkThatMeansSomethingElse) {
  const test::ScratchFolder scratch;
  Recipe recipe = test::smallRecipe();
  recipe.others_order = "closest_first";
  const NetworkPlan plan = networkPlan(recipe);
  planner::nn::writeSafetensors(scratch / "first.safetensors",
                                weightFile(plan, initialState(recipe).parameters, "test"));
  recipe.begin_with = scratch / "first.safetensors";
  EXPECT_NO_THROW(initialState(recipe));
  recipe.others_order = "closest_last";
  EXPECT_THAT(test::startupErrorOf([&] { initialState(recipe); }),
              testing::AllOf(testing::HasSubstr("others_order"),
                             testing::HasSubstr("closest_last, as the recipe says"),
                             testing::HasSubstr("closest_first")));
}

TEST_P(ExactTraining, IsTheSameTwice) {
  const auto one = trainerOf(recipe());
  const auto other = trainerOf(recipe());
  iterate(*one, 4);
  iterate(*other, 4);
  EXPECT_EQ(one->state().parameters, other->state().parameters);
  EXPECT_EQ(one->state().agent_steps, other->state().agent_steps);
  EXPECT_NE(one->state().parameters, initialState(recipe()).parameters);
}

TEST_P(ExactTraining, ContinuesExactlyFromACheckpoint) {
  const test::ScratchFolder scratch;
  std::optional<RunFolder> folder(RunFolder::create(scratch / "run", recipe()));
  const auto whole = trainerOf(recipe());
  iterate(*whole, 3);
  whole->renewEnvironments();
  folder->saveCheckpoint(*whole, {10.0, 5.0});
  iterate(*whole, 3);

  folder.reset();
  RunFolder again = RunFolder::open(scratch / "run");
  RunFolder::Checkpoint checkpoint = again.loadCheckpoint(whole->layout());
  EXPECT_EQ(checkpoint.expense.cpu_s, 5.0);
  const auto resumed = makeTrainer(again.recipe(), 1, std::move(checkpoint.state));
  iterate(*resumed, 3);
  EXPECT_EQ(whole->state().parameters, resumed->state().parameters);
  EXPECT_EQ(whole->state().averaged, resumed->state().averaged);
  EXPECT_EQ(whole->state().agent_steps, resumed->state().agent_steps);
}

std::string algorithmOf(const testing::TestParamInfo<std::string>& training) {
  return training.param;
}

INSTANTIATE_TEST_SUITE_P(Trainer, ExactTraining, testing::Values("ppo", "ga3c"), algorithmOf);

// What learners failed at is met again until the next checkpoint, and must not outlive it.
TEST(Trainer, ContinuesExactlyWithHardCases) {
  Recipe recipe = test::smallRecipe();
  recipe.ppo.environments = 40;
  recipe.ppo.minibatch = 400;
  recipe.stages[0].hard_share = 0.9;
  const auto whole = trainerOf(recipe);
  iterate(*whole, 20);
  TrainingState checkpoint = whole->state();
  whole->renewEnvironments();
  iterate(*whole, 10);
  const auto resumed = makeTrainer(recipe, 1, std::move(checkpoint));
  iterate(*resumed, 10);
  EXPECT_EQ(whole->state().parameters, resumed->state().parameters);
  EXPECT_EQ(whole->state().agent_steps, resumed->state().agent_steps);

  recipe.stages[0].hard_share = 0.0;
  const auto without = trainerOf(recipe);
  iterate(*without, 20);
  without->renewEnvironments();
  iterate(*without, 10);
  EXPECT_NE(without->state().parameters, whole->state().parameters) << "no hard case was met";
}

// They are not of the policy that learns, and would end every iteration at once.
TEST(Trainer, MirroredSamplesAreNoDivergence) {
  Recipe recipe = test::smallRecipe();
  recipe.ppo.environments = 40;
  recipe.ppo.minibatch = 200;
  recipe.ppo.max_divergence = 1e-3;
  recipe.ppo.mirrored_share = 0.9;
  TrainingState leaning = initialState(recipe);
  const ParameterLayout::Layer policy = networkPlan(recipe).layout().layer("policy");
  leaning.parameters[policy.bias] = 3.0F;  // ahead, and 30 degrees to the right
  const auto trainer = makeTrainer(recipe, 1, std::move(leaning));
  iterate(*trainer, 4);
  EXPECT_GE(trainer->state().adam.updates, 4);
}

TEST(Trainer, StopsWhenItDiverges) {
  Recipe recipe = test::smallRecipe();
  recipe.stages[0].learning_rate = {1e30, 1e30};
  const auto trainer = trainerOf(recipe);
  EXPECT_THAT(test::startupErrorOf([&] { iterate(*trainer, 5); }),
              testing::HasSubstr("gradient: expected finite numbers"));
}

TEST(Trainer, IsTheSameWithAnyNumberOfThreads) {
  const auto alone = trainerOf(test::smallRecipe(), 1);
  const auto together = trainerOf(test::smallRecipe(), 3);
  iterate(*alone, 6);
  iterate(*together, 6);
  EXPECT_EQ(alone->state().parameters, together->state().parameters);
  EXPECT_EQ(alone->state().averaged, together->state().averaged);
  EXPECT_EQ(alone->state().agent_steps, together->state().agent_steps);
}

TEST(Trainer, DependsOnItsSeed) {
  Recipe recipe = test::smallRecipe();
  const auto one = trainerOf(recipe);
  recipe.seed = 2;
  const auto other = trainerOf(recipe);
  EXPECT_NE(one->state().parameters, other->state().parameters);
}

TEST(RunFolder, IsForOneAtATime) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "run";
  RunFolder folder = RunFolder::create(path, test::smallRecipe());
  folder.saveCheckpoint(*trainerOf(test::smallRecipe()), {});
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

TEST(TrainingFigure, TakesRunsOfOneNameTogether) {
  const auto groups = groupsOf({"out/lstm.1", "ws4.1/", "out/lstm.20", "other", "x.y"});
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0].name, "lstm");
  EXPECT_EQ(groups[0].runs, (std::vector<std::string>{"out/lstm.1", "out/lstm.20"}));
  EXPECT_EQ(groups[1].name, "ws4");
  EXPECT_EQ(groups[2].name, "");
  EXPECT_EQ(groups[2].runs, (std::vector<std::string>{"other", "x.y"}));
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
  const auto trainer = trainerOf(recipe, 2);
  iterate(*trainer, 5);
  const double before = trainer->iterate().success;
  IterationFigures figures;
  while (trainer->state().agent_steps < 60'000) {
    figures = trainer->iterate();
  }
  EXPECT_LT(before, 0.5);
  EXPECT_GT(figures.success, 0.9);
}

// Asynchronous, with more threads than environments could keep busy.
TEST(Ga3cTrainer, LearnsToGoToItsGoalInManyThreads) {
  Recipe recipe = test::smallRecipe();
  recipe.algorithm = "ga3c";
  recipe.ga3c.environments = 16;
  recipe.ga3c.iteration_samples = 5000;
  recipe.stages[0].min_agents = 1;
  recipe.stages[0].max_agents = 1;
  recipe.stages[0].trap_share = 0.0;
  recipe.stages[0].sharp_share = 0.0;
  recipe.stages[0].agent_steps = 150'000;
  recipe.stages[0].learning_rate = {5e-4, 5e-4};
  const auto trainer = trainerOf(recipe, 3);
  const double before = trainer->iterate().success;
  IterationFigures figures;
  while (trainer->state().agent_steps < 150'000) {
    figures = trainer->iterate();
  }
  EXPECT_LT(before, 0.5);
  EXPECT_GT(figures.success, 0.9);
}

TEST(Imitation, LearnsWhatTheExpertDoesAndIsWorth) {
  Recipe recipe = test::smallRecipe();
  recipe.potential = false;
  recipe.imitation = {.updates = 150, .batch = 200, .learning_rate = 1e-3, .cases = 40};
  const Samples watched = gatherDemonstrations(recipe);
  ASSERT_GT(watched.size(), 500U);
  for (const float worth : watched.target) {
    EXPECT_TRUE(worth > 0.0F ? worth <= 1.0F : worth >= -0.25F);
  }
  Parameters parameters = initialState(test::smallRecipe()).parameters;
  Recipe shortly = recipe;
  shortly.imitation.updates = 1;
  Parameters beginner = parameters;
  const double before = imitate(shortly, watched, beginner);
  EXPECT_LT(imitate(recipe, watched, parameters), 0.7 * before);
}

// Like an observation made in a mirrored world.
TEST(Samples, AreMirrored) {
  core::RandomStream random(5, "mirror");
  planner::Scene scene = planner::randomScene(random, 3, 5.0);
  planner::ObservationEncoder encoder(19, planner::OthersOrder::kClosestLast);
  Samples samples;
  samples.add(encoder.encode(scene.ego, scene.others));
  samples.action[0] = 1;  // full speed, a little to the right
  samples.mirror(0);
  const auto flip = [](Eigen::Vector2d& v) { v.y() = -v.y(); };
  flip(scene.ego.position_world_m);
  flip(scene.ego.velocity_world_mps);
  flip(scene.ego.goal_world_m);
  scene.ego.heading_world_rad = -scene.ego.heading_world_rad;
  for (core::OtherAgent& other : scene.others) {
    flip(other.position_world_m);
    flip(other.velocity_world_mps);
  }
  const planner::Observation& expected = encoder.encode(scene.ego, scene.others);
  for (std::size_t i = 0; i < expected.ego.size(); ++i) {
    EXPECT_NEAR(samples.ego[0][i], expected.ego[i], 1e-5);
  }
  for (std::size_t k = 0; k < expected.others.size(); ++k) {
    for (std::size_t i = 0; i < expected.others[k].size(); ++i) {
      EXPECT_NEAR(samples.others[k][i], expected.others[k][i], 1e-5);
    }
  }
  EXPECT_EQ(samples.action[0], 3);
}

}  // namespace
}  // namespace roundabout::learning
