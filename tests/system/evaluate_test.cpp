// `roundabout evaluate` as a user types it.

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class Evaluate : public FlightLab {
 protected:
  Ended evaluate(std::vector<std::string> arguments, const std::string& folder = "out") {
    arguments.insert(arguments.begin(), "evaluate");
    arguments.insert(arguments.end(), {"--out", (scratch_ / folder).string()});
    return run("roundabout", arguments);
  }
  std::string textOf(const std::string& file) const {
    std::ifstream in(scratch_ / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void expectRefusal(const std::vector<std::string>& arguments, const std::string& words) {
    const Ended ended = evaluate(arguments);
    EXPECT_EQ(ended.status.code, 2);
    ASSERT_EQ(ended.lines.size(), 1u);
    EXPECT_THAT(ended.lines[0], AllOf(HasSubstr(words), HasSubstr("expected"), HasSubstr("found")));
    EXPECT_FALSE(std::filesystem::exists(scratch_ / "out")) << "nothing half written";
  }
};

const std::vector<std::string> kSmall{"--policy", "orca",    "--generate", "circle", "--agents",
                                      "4",        "--count", "5",          "--seed", "2"};

TEST_F(Evaluate, LeavesNumbersAndPictures) {
  std::vector<std::string> arguments = kSmall;
  arguments.insert(arguments.end(), {"--draw", "0", "--animate", "1"});
  const Ended ended = evaluate(arguments);
  EXPECT_TRUE(ended.status.clean()) << ended.status.describe();
  EXPECT_THAT(ended.lines, Contains(HasSubstr("success %")));
  for (const char* file : {"cases.csv", "summary.json", "summary.txt", "run.json", "comparison.png",
                           "comparison.svg", "orca_4_agents_0.png", "orca_4_agents_1.gif"}) {
    EXPECT_GT(std::filesystem::file_size(out() / file), 100u) << file;
  }
  EXPECT_EQ(nlohmann::json::parse(textOf("out/summary.json"))["scores"][0]["cases"], 5);
}

TEST_F(Evaluate, DrawsWhereNobodyArrivedAndAmongObstacles) {
  const std::string course = write(
      "course.yaml", "obstacles: [{name: box, points_m: [[-1, -1], [1, -1], [1, 1], [-1, 1]]}]");
  const Ended ended = evaluate({"--policy", "orca", "--cases",
                                write("cases.csv",
                                      "case,agent,start_x,start_y,goal_x,goal_y,radius,pref_speed\n"
                                      "0,0,-3,0,3,0,0.3,1\n"),
                                "--obstacles", course, "--draw", "0", "--animate", "0"});
  EXPECT_TRUE(ended.status.clean()) << ended.status.describe();
  EXPECT_GT(std::filesystem::file_size(out() / "comparison.png"), 100u);
  EXPECT_THAT(textOf("out/orca_1_agent_0.svg"), HasSubstr("<path"));
}

TEST_F(Evaluate, DoesNotDependOnTheNumberOfThreads) {
  std::vector<std::string> arguments = kSmall;
  arguments.insert(arguments.end(), {"--no-figures", "--threads", "1"});
  evaluate(arguments, "one");
  arguments.back() = "3";
  evaluate(arguments, "three");
  EXPECT_FALSE(textOf("one/cases.csv").empty());
  EXPECT_EQ(textOf("one/cases.csv"), textOf("three/cases.csv"));
}

TEST_F(Evaluate, GoesOnAfterAnInterruption) {
  std::vector<std::string> arguments = kSmall;
  arguments.emplace_back("--no-figures");
  evaluate(arguments);
  const std::string whole = textOf("out/cases.csv");
  const std::string summary = textOf("out/summary.json");
  std::filesystem::resize_file(out() / "cases.csv", whole.size() - 20);  // in the last row
  arguments.emplace_back("--resume");
  EXPECT_TRUE(evaluate(arguments).status.clean());
  EXPECT_EQ(textOf("out/cases.csv"), whole);
  EXPECT_EQ(textOf("out/summary.json"), summary);
}

TEST_F(Evaluate, DoesNotGoOnWithOtherCasesUnderTheSameName) {
  const std::string titles = "case,agent,start_x,start_y,goal_x,goal_y,radius,pref_speed\n";
  const std::vector<std::string> arguments{"--policy", "orca", "--no-figures", "--cases",
                                           write("cases.csv", titles + "0,0,0,0,2,0,0.3,1\n")};
  EXPECT_TRUE(evaluate(arguments).status.clean());
  write("cases.csv", titles + "0,0,0,0,3,0,0.3,1\n");
  std::vector<std::string> again = arguments;
  again.emplace_back("--resume");
  const Ended ended = evaluate(again);
  EXPECT_EQ(ended.status.code, 2);
  EXPECT_THAT(ended.lines.back(), HasSubstr("run.json: --resume"));
  EXPECT_THAT(ended.lines.back(), HasSubstr("one with other cases_hash"));
}

TEST_F(Evaluate, RefusesWhatIsWrongInOneLine) {
  expectRefusal({"--policy", "orka", "--suite", "presets"}, "\"orca\"");
  expectRefusal({"--policy", "orca", "--suite", "preset"}, "--suite: name");
  expectRefusal({"--policy", "orca", "--suite", "presets", "--rules", "my"}, "--rules: name");
  expectRefusal({"--policy", "orca"}, "--suite, --cases, --generate");
  expectRefusal({"--policy", "cadrl", "--suite", "presets"}, "cadrl:WEIGHTS");
  expectRefusal({"--policy", "ga3c_cadrl:/no/such.safetensors", "--suite", "presets"},
                "/no/such.safetensors");
  expectRefusal({"--policy", "orca", "--suite", "presets", "--draw", "7"}, "--draw");
  expectRefusal({"--policy", "non_cooperative", "--suite", "obstacles"}, "--policy");
  expectRefusal({"--policy", "orca", "--generate", "random", "--speed", "2", "1"}, "--speed");
  const std::string cases = write(
      "cases.csv", "case,agent,start_x,start_y,goal_x,goal_y,radius,pref_speed\n0,0,0,0,1,0,x,1\n");
  expectRefusal({"--policy", "orca", "--cases", cases}, "cases.csv:2: radius");
}

TEST_F(Evaluate, ListsWhatThereIs) {
  const Ended ended = run("roundabout", {"evaluate", "--list"});
  EXPECT_TRUE(ended.status.clean());
  for (const char* word : {"ga3c_cadrl[:WEIGHTS]", "random500", "published", "lab"}) {
    EXPECT_THAT(ended.lines, Contains(HasSubstr(word)));
  }
}

/// Nothing can be found by its name alone while it lives.
class NoPath {
 public:
  NoPath() { ::setenv("PATH", "/no/such/folder", 1); }
  ~NoPath() { ::setenv("PATH", usual_.c_str(), 1); }
  NoPath(const NoPath&) = delete;
  NoPath& operator=(const NoPath&) = delete;

 private:
  std::string usual_ = ::getenv("PATH") == nullptr ? "" : ::getenv("PATH");
};

using Cross = FlightLab;

TEST_F(Cross, RefusesPicturesThatCannotBeDrawnBeforeTheFirstRun) {
  const std::vector<std::string> cross{
      "cross",    ROUNDABOUT_SOURCE_DIR "/experiments/pedestrians.yaml",
      "--policy", "orca",
      "--csv",    (scratch_ / "runs.csv").string(),
      "--runs",   "1000000"};
  const auto refusal = [&](const std::string& folder) {
    std::vector<std::string> arguments = cross;
    arguments.insert(arguments.end(), {"--pictures", folder});
    const Ended ended = run("roundabout", arguments);
    EXPECT_EQ(ended.status.code, 2);
    EXPECT_EQ(ended.lines.size(), 1u);
    return ended.lines.empty() ? std::string() : ended.lines[0];
  };
  EXPECT_THAT(refusal(write("file", "") + "/pictures"), HasSubstr("cross: --pictures: expected"));
  const NoPath no_path;
  EXPECT_THAT(refusal((scratch_ / "pictures").string()), HasSubstr("gnuplot-nox"));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "runs.csv"));
}

}  // namespace
}  // namespace roundabout::test
