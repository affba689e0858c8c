// `roundabout train` as a user types it.

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/nn/safetensors.h"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr const char* kTiny = R"(
checkpoint_agent_steps: 300
ppo: {environments: 8, steps: 8, minibatch: 128}
validation: {every_agent_steps: 1000, agents: [2], cases: 2}
stages:
  - {name: a first, agent_steps: 1000, max_agents: 3}
  - {name: tiny, agent_steps: 5000, max_agents: 3}
)";

class Train : public FlightLab {
 protected:
  std::vector<std::string> arguments(const std::string& folder) const {
    return {"train", write("tiny.yaml", kTiny), "--out", (scratch_ / folder).string()};
  }
  planner::nn::TensorFile fileOf(const std::string& path) const {
    return planner::nn::readSafetensors(scratch_ / path);
  }
  void expectSameNetwork(const std::string& a, const std::string& b) const {
    const auto left = fileOf(a).tensors;
    const auto right = fileOf(b).tensors;
    ASSERT_EQ(left.size(), right.size());
    for (const auto& [name, tensor] : left) {
      EXPECT_EQ(tensor.values, right.at(name).values) << name;
    }
  }
};

TEST_F(Train, LeavesNetworksThatFlyAndFigures) {
  const Ended ended = run("roundabout", arguments("run"));
  EXPECT_TRUE(ended.status.clean()) << ended.status.describe();
  for (const char* file :
       {"recipe.yaml", "progress.csv", "validation.csv", "network.safetensors",
        "after_a_first.safetensors", "best.safetensors", "checkpoint.safetensors"}) {
    EXPECT_GT(std::filesystem::file_size(scratch_ / "run" / file), 50u) << file;
  }
  const Ended flown =
      run("roundabout",
          {"evaluate", "--policy", "ga3c_cadrl:" + (scratch_ / "run/best.safetensors").string(),
           "--generate", "circle", "--agents", "2", "--count", "1", "--no-figures", "--out",
           (scratch_ / "flown").string()});
  EXPECT_TRUE(flown.status.clean()) << flown.status.describe();
  const std::string mean = scratch_ / "mean.safetensors";
  const Ended averaged =
      run("roundabout", {"policy", "average", scratch_ / "run/after_a_first.safetensors",
                         scratch_ / "run/network.safetensors", "-o", mean});
  EXPECT_TRUE(averaged.status.clean()) << averaged.status.describe();
  EXPECT_THAT(fileOf("mean.safetensors").metadata.at("provenance"),
              HasSubstr("mean of 2 networks: trained by roundabout train"));
}

TEST_F(Train, EndsTheSameWhenItWasKilledAndResumed) {
  run("roundabout", arguments("whole"));
  std::vector<std::string> slow = arguments("killed");
  cli::ChildProcess& process = start("roundabout", slow);
  waitUntil("the first checkpoint", [&] {
    return std::filesystem::exists(scratch_ / "killed" / "checkpoint.safetensors");
  });
  process.signal(SIGKILL);
  ASSERT_EQ(finish(process).status.signal, SIGKILL) << "it had ended already: this shows nothing";
  const Ended resumed = run("roundabout", {"train", "--resume", "--threads", "1", "--out",
                                           (scratch_ / "killed").string()});
  EXPECT_TRUE(resumed.status.clean()) << resumed.status.describe();
  expectSameNetwork("whole/network.safetensors", "killed/network.safetensors");
}

TEST_F(Train, RefusesInOneLineWhatItCannotDo) {
  const std::string recipe = write("bad.yaml", "stages: [{name: a, trap_shares: 1}]");
  std::filesystem::create_directory(scratch_ / "there");
  const std::string there = (scratch_ / "there").string();
  const std::string absent = (scratch_ / "absent").string();
  for (const std::vector<std::string>& each :
       std::vector<std::vector<std::string>>{{"train", recipe, "--out", absent},
                                             {"train", write("tiny.yaml", kTiny), "--out", there},
                                             {"train", "--resume", "--out", there},
                                             {"train", "/no/such/recipe.yaml", "--out", absent},
                                             {"train", write("tiny.yaml", kTiny)}}) {
    const Ended ended = run("roundabout", each);
    EXPECT_EQ(ended.status.code, 2);
    ASSERT_EQ(ended.lines.size(), 1u);
    EXPECT_THAT(ended.lines[0], AllOf(HasSubstr("expected"), HasSubstr("found")));
  }
  EXPECT_FALSE(std::filesystem::exists(absent));
  const Ended seeded = run("roundabout", {"train", "--resume", "--seed", "7", "--out", there});
  EXPECT_THAT(seeded.lines, testing::ElementsAre(HasSubstr("found --seed 7")));
}

}  // namespace
}  // namespace roundabout::test
