#include "learning/training/train_command.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "planner/nn/safetensors.h"
#include "tests/learning/training/small_recipe.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::learning {
namespace {

namespace fs = std::filesystem;

/// `train` in a process of its own, which can be killed.
pid_t startTraining(const std::string& arguments) {
  const pid_t child = ::fork();
  if (child == 0) {
    int status = 0;
    try {
      CLI::App app;
      addTrainCommand(app, status);
      app.parse("train --threads 1 " + arguments);
    } catch (...) {
      status = 2;
    }
    ::_exit(status);
  }
  return child;
}

int statusOf(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

void waitFor(const fs::path& file) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!fs::exists(file) && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(fs::exists(file)) << file << " is not there after 30 s";
}

void expectSameNetwork(const std::string& one, const std::string& other) {
  const planner::nn::TensorFile first = planner::nn::readSafetensors(one);
  const planner::nn::TensorFile second = planner::nn::readSafetensors(other);
  ASSERT_EQ(first.tensors.size(), second.tensors.size());
  for (const auto& [name, tensor] : first.tensors) {
    EXPECT_EQ(tensor.values, second.tensors.at(name).values) << name;
  }
}

class TrainCommand : public testing::TestWithParam<std::string> {
 protected:
  TrainCommand() {
    Recipe recipe = test::smallRecipe();
    recipe.algorithm = GetParam();
    if (recipe.algorithm == "ga3c") {
      recipe.stages[0].sharp_share = 0.0;
    }
    recipe.ga3c.environments = 6;
    recipe.ga3c.iteration_samples = 200;
    recipe.stages[0].agent_steps = 6'000;
    recipe.checkpoint_agent_steps = 1'000;
    recipe.validation.every_agent_steps = 1e9;
    recipe.validation.agents = {2};
    recipe.validation.cases = 2;
    std::ofstream(scratch_ / "recipe.yaml") << writeRecipe(recipe);
  }

  std::string begin(const std::string& folder) const {
    return std::string(scratch_ / "recipe.yaml") + " --out " + std::string(scratch_ / folder);
  }

  test::ScratchFolder scratch_;
};

TEST_P(TrainCommand, EndsAlikeTwiceAndAfterBeingKilled) {
  ASSERT_EQ(statusOf(startTraining(begin("whole"))), 0);
  ASSERT_EQ(statusOf(startTraining(begin("again"))), 0);
  expectSameNetwork(scratch_ / "whole/network.safetensors", scratch_ / "again/network.safetensors");

  // Also of iterations in which no episode ended.
  std::ifstream progress(scratch_ / "whole/progress.csv");
  const std::string rows(std::istreambuf_iterator<char>(progress), {});
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3) << "columns, first and last report";
  EXPECT_EQ(rows.find("nan"), std::string::npos) << rows;

  const pid_t child = startTraining(begin("killed"));
  waitFor(scratch_ / "killed/network.safetensors");
  ::kill(child, SIGKILL);
  ASSERT_TRUE(WIFSIGNALED(statusOf(child))) << "it had come to its end already";
  ASSERT_EQ(statusOf(startTraining("--resume --out " + std::string(scratch_ / "killed"))), 0);
  expectSameNetwork(scratch_ / "whole/network.safetensors",
                    scratch_ / "killed/network.safetensors");
}

TEST_P(TrainCommand, BeginsAgainWhatWasKilledBeforeItsFirstCheckpoint) {
  ASSERT_EQ(statusOf(startTraining(begin("whole"))), 0);
  fs::create_directory(scratch_ / "early");
  fs::copy_file(scratch_ / "whole/recipe.yaml", scratch_ / "early/recipe.yaml");
  ASSERT_EQ(statusOf(startTraining("--resume --out " + std::string(scratch_ / "early"))), 0);
  expectSameNetwork(scratch_ / "whole/network.safetensors", scratch_ / "early/network.safetensors");
}

TEST_P(TrainCommand, LeavesNoFolderOfARunThatCannotBegin) {
  const std::string from_nowhere = " --set begin_with=" + std::string(scratch_ / "no.safetensors");
  const int status = statusOf(startTraining(begin("run") + from_nowhere));
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_FALSE(fs::exists(scratch_ / "run"));
  EXPECT_EQ(statusOf(startTraining(begin("run"))), 0);
}

std::string algorithmOf(const testing::TestParamInfo<std::string>& training) {
  return training.param;
}

INSTANTIATE_TEST_SUITE_P(Training, TrainCommand, testing::Values("ppo", "ga3c"), algorithmOf);

}  // namespace
}  // namespace roundabout::learning
