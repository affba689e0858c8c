#include "planner/policy_tools/policy_commands.h"

#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/policy_tools/query.h"
#include "tests/support/cadrl_weights.h"
#include "tests/support/drl_maca_weights.h"
#include "tests/support/reference.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStdout;

class PolicyCommands : public ::testing::Test {
 protected:
  PolicyCommands() { addPolicyCommands(app_); }

  void run(const std::string& arguments) { app_.parse(arguments, false); }

  CLI::App app_;
  test::ScratchFolder folder_;
  std::string weights_ = folder_ / "weights.safetensors";
};

TEST_F(PolicyCommands, ImportRefusesAMissingCheckpointAndWritesNothing) {
  EXPECT_THAT(
      test::startupErrorOf([this] { run("policy import /nowhere/network -o " + weights_); }),
      HasSubstr("/nowhere/network.index: checkpoint index: expected a file"));
  EXPECT_FALSE(std::filesystem::exists(weights_));
}

TEST_F(PolicyCommands, ImportRefusesAnOrderThatThereIsNot) {
  EXPECT_THROW(run("policy import /nowhere/network --order closest -o " + weights_),
               CLI::ValidationError);
}

TEST_F(PolicyCommands, ImportDeclaresTheOrderThatItIsTold) {
  const std::string prefix =
      test::referenceFolder() / "ga3c_cadrl/checkpoints/gym_IROS18_01900000/network_01900000";
  if (!std::filesystem::exists(prefix + ".index")) {
    GTEST_SKIP() << "no published network in " << test::referenceFolder();
  }
  run("policy import " + prefix + " -o " + weights_);
  EXPECT_EQ(nn::readSafetensors(weights_).metadata.at("others_order"), "closest_last");
  run("policy import " + prefix + " --order closest_first -o " + weights_);
  EXPECT_EQ(nn::readSafetensors(weights_).metadata.at("others_order"), "closest_first");
}

TEST_F(PolicyCommands, ImportTakesAPublishedSaCadrlNetwork) {
  const std::string published = folder_ / "published.safetensors";
  nn::writeSafetensors(published, test::randomPublishedCadrl());
  run("policy import " + published + " -o " + weights_);
  CaptureStdout();
  run("policy info " + weights_);
  EXPECT_THAT(GetCapturedStdout(),
              AllOf(HasSubstr("architecture      sa_cadrl_value\n"),
                    HasSubstr("provenance        imported from published.safetensors\n"),
                    HasSubstr("layer1/other_from_other [8, 50]          400\n")));
  CaptureStdout();
  run("policy info " + published);
  EXPECT_THAT(GetCapturedStdout(), HasSubstr("input_avg         [31]              31\n"));
}

TEST_F(PolicyCommands, InfoSaysWhatTheFileHolds) {
  test::writeRandomGa3cCadrl(weights_);
  CaptureStdout();
  run("policy info " + weights_);
  EXPECT_THAT(GetCapturedStdout(), AllOf(HasSubstr("architecture      ga3c_cadrl_lstm\n"),
                                         HasSubstr("provenance        random, for tests\n"),
                                         HasSubstr("lstm/kernel       [71, 256]      18176\n"),
                                         HasSubstr("parameters                      170764\n")));
}

TEST_F(PolicyCommands, InfoAndQueryKnowNetworksThatShareWeights) {
  nn::writeSafetensors(weights_, test::randomGa3cCadrl(2, kWeightSharingArchitecture, 3));
  CaptureStdout();
  run("policy info " + weights_);
  EXPECT_THAT(GetCapturedStdout(), AllOf(HasSubstr("architecture      ga3c_cadrl_ws\n"),
                                         HasSubstr("layer1/kernel     [196, 256]     50176\n"),
                                         HasSubstr("parameters                      185676\n")));
  std::istringstream lines(R"({"num_other_agents": 0, "ego": [5.0, 0.1, 1.0, 0.5], "others": []})");
  std::ostringstream out;
  std::ostringstream errors;
  EXPECT_EQ(queryPolicy(weights_, lines, out, errors), 0);
  EXPECT_THAT(out.str(), HasSubstr("\"value\":"));
}

TEST_F(PolicyCommands, InfoKnowsNetworksThatScan) {
  nn::writeSafetensors(weights_, test::randomDrlMaca());
  CaptureStdout();
  run("policy info " + weights_);
  EXPECT_THAT(GetCapturedStdout(),
              AllOf(HasSubstr("architecture      drl_maca\n"), HasSubstr("beams             512\n"),
                    HasSubstr("actor/dense1/kernel ")));
  nn::TensorFile file = test::randomDrlMaca();
  file.tensors.erase("actor/linear/bias");
  nn::writeSafetensors(weights_, file);
  CaptureStdout();
  const std::string error = test::startupErrorOf([this] { run("policy info " + weights_); });
  GetCapturedStdout();
  EXPECT_THAT(error, HasSubstr("tensor actor/linear/bias: expected shape [1]"));
}

TEST_F(PolicyCommands, InfoRefusesWhatNoPolicyAccepts) {
  nn::TensorFile file = test::randomGa3cCadrl(1);
  file.metadata["architecture"] = "another";
  nn::writeSafetensors(weights_, file);
  CaptureStdout();
  const std::string error = test::startupErrorOf([this] { run("policy info " + weights_); });
  EXPECT_THAT(GetCapturedStdout(), HasSubstr("another"));
  EXPECT_THAT(error, HasSubstr("metadata architecture: expected one of ga3c_cadrl_lstm, "));
}

TEST_F(PolicyCommands, QueryFailsAtTheEndWhenALineWasBad) {
  test::writeRandomGa3cCadrl(weights_);
  std::istringstream lines("nonsense\n");
  std::streambuf* const standard_input = std::cin.rdbuf(lines.rdbuf());
  int exit_status = 0;
  try {
    run("policy query " + weights_);
  } catch (const CLI::RuntimeError& error) {
    exit_status = error.get_exit_code();
  }
  std::cin.rdbuf(standard_input);
  EXPECT_EQ(exit_status, 1);
}

TEST_F(PolicyCommands, GatesWritesATableAndItsFigure) {
  test::writeRandomGa3cCadrl(weights_);
  const std::string scenes = std::string(ROUNDABOUT_SOURCE_DIR) + "/experiments/gates/";
  CaptureStdout();
  run("policy gates " + weights_ + " --scene " + scenes + "approaching.yaml --scene " + scenes +
      "leaving.yaml --out " + (folder_ / "out").string());
  EXPECT_THAT(GetCapturedStdout(), HasSubstr("\nleaving,6,"));
  for (const char* file : {"out/gates.csv", "out/gates.png", "out/gates.svg"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / file)) << file;
  }
}

TEST_F(PolicyCommands, AskForTheirArguments) {
  for (const char* arguments : {"policy", "policy import x", "policy import -o x", "policy info",
                                "policy query", "policy gates", "policy nonsense"}) {
    EXPECT_THROW(run(arguments), CLI::ParseError) << arguments;
  }
}

}  // namespace
}  // namespace roundabout::planner
