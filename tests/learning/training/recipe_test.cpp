#include "learning/training/recipe.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/learning/training/small_recipe.h"
#include "tests/support/startup_error.h"

namespace roundabout::learning {
namespace {

using ::testing::HasSubstr;

std::string errorOf(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return test::startupErrorOf([&] { parseRecipe(yaml, "recipe.yaml", overrides); });
}

TEST(Recipe, IsReadBackAsItWasWritten) {
  const std::string text = writeRecipe(test::smallRecipe());
  EXPECT_EQ(writeRecipe(parseRecipe(text, "recipe.yaml", {})), text);
}

TEST(Recipe, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(errorOf("ppo: {epoch: 3}\nstages: [{name: a}]"), HasSubstr("epochs"));
  EXPECT_THAT(errorOf("network: transformer\nstages: [{name: a}]"), HasSubstr("network"));
  EXPECT_THAT(errorOf("seed: 1"), HasSubstr("stages"));
  EXPECT_THAT(errorOf("stages: [{min_agents: 4, max_agents: 2}]"),
              HasSubstr("stages[0].max_agents"));
  EXPECT_EQ(errorOf("stages: [{name: a}]", {"seed=4"}), "");
}

TEST(Recipe, RefusesWhatWouldDoNothingOrBreak) {
  const std::string stages = "\nstages: [{name: a}]";
  EXPECT_THAT(errorOf("validation: {agents: []}" + stages), HasSubstr("validation.agents"));
  EXPECT_THAT(errorOf("shards: 8\nppo: {minibatch: 4}" + stages), HasSubstr("ppo.minibatch"));
  EXPECT_THAT(errorOf("algorithm: ga3c\nppo: {mirrored_share: 0.5}" + stages),
              HasSubstr("ppo.mirrored_share"));
  EXPECT_THAT(errorOf("algorithm: ga3c\nstages: [{name: a, sharp_share: 0.5}]"),
              HasSubstr("stages[0].sharp_share"));
  EXPECT_THAT(errorOf("algorithm: ga3c\nstages: [{name: a, hard_share: 0.5}]"),
              HasSubstr("stages[0].hard_share"));
  EXPECT_THAT(errorOf("stages: [{name: a, world: lab, hard_share: 0.5}]"),
              HasSubstr("stages[0].hard_share"));
}

TEST(Recipe, GivesEveryStageAFileOfItsOwn) {
  EXPECT_THAT(errorOf("stages: [{name: a b}, {name: c}, {name: a/b}]"),
              testing::AllOf(HasSubstr("stages[2].name"), HasSubstr("that of stages[0]"),
                             HasSubstr("after_a_b.safetensors")));
  EXPECT_THAT(errorOf("stages: [{name: \"few, 4\"}]"), HasSubstr("stages[0].name"));
  const Recipe unnamed = parseRecipe("stages: [{min_agents: 2}, {name: a}, {}]", "recipe.yaml", {});
  EXPECT_EQ(unnamed.stages[0].name, "stage 1");
  EXPECT_EQ(unnamed.stages[2].name, "stage 3");
}

TEST(Recipe, SaysWhichStageItIsTheTimeFor) {
  Recipe recipe = test::smallRecipe();
  recipe.stages.push_back(recipe.stages[0]);
  recipe.stages[1].name = "second";
  EXPECT_EQ(totalAgentSteps(recipe), 2000.0);
  EXPECT_EQ(stageAt(recipe, 999.0).stage->name, "small");
  EXPECT_EQ(stageAt(recipe, 1500.0).stage->name, "second");
  EXPECT_DOUBLE_EQ(stageAt(recipe, 1500.0).done, 0.5);
  EXPECT_DOUBLE_EQ(stageAt(recipe, 9999.0).done, 1.0);
  EXPECT_DOUBLE_EQ(recipe.stages[0].at({2.0, 4.0}, 0.5), 3.0);
}

TEST(Recipe, EveryOneThatShipsIsRead) {
  int count = 0;
  const std::string folder = std::string(ROUNDABOUT_SOURCE_DIR) + "/experiments/training";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") {
      continue;
    }
    EXPECT_NO_THROW(readRecipe(entry.path(), {})) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace roundabout::learning
