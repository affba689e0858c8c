#include "learning/evaluation/obstacle_course.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/polygon.h"
#include "learning/evaluation/generate.h"
#include "planner/policies/table.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::learning {
namespace {

using ::testing::HasSubstr;

class ObstacleCourse : public ::testing::Test {
 protected:
  ObstacleCourse() {
    evaluation_.rules = makeRules("published");
    evaluation_.suite = {"mine", {{"3 agents", {circleCase(3, 3.0)}}}, {}};
    enter("orca");
  }

  void enter(const std::string& policy) {
    evaluation_.contestants.push_back({policy, planner::makePolicy(policy, {})});
  }
  std::string file(const std::string& yaml) {
    const std::string path = scratch_ / "course.yaml";
    std::ofstream(path) << yaml;
    return path;
  }
  void add(const std::string& points) {
    addObstacles(evaluation_.suite, file("obstacles: [{name: box, points_m: " + points + "}]\n"));
  }
  std::string check() {
    return test::startupErrorOf([this] { checkObstacles(evaluation_); });
  }

  test::ScratchFolder scratch_;
  Evaluation evaluation_;
};

TEST_F(ObstacleCourse, StandsInEveryCaseCounterClockwise) {
  add("[[-1, -1], [-1, 1], [1, 1], [1, -1]]");
  const TestCase& first = evaluation_.suite.groups[0].cases[0];
  ASSERT_EQ(first.obstacles.size(), 1u);
  EXPECT_DOUBLE_EQ(core::signedArea(first.obstacles[0]), 4.0);
  EXPECT_EQ(check(), "");
}

TEST_F(ObstacleCourse, NobodyBeginsOrEndsInAnObstacle) {
  add("[[3.2, -1], [4, -1], [4, 1], [3.2, 1]]");
  EXPECT_EQ(check(),
            "mine, 3 agents, case 0: agent 0, start: expected more than its radius, 0.5 m, from "
            "every obstacle, found 0.200 m");
  evaluation_.suite.groups[0].cases[0] = circleCase(3, 3.0);
  add("[[-2, -1], [-4, -1], [-4, 1], [-2, 1]]");
  EXPECT_THAT(check(), HasSubstr("agent 0, goal: "));
  EXPECT_THAT(check(), HasSubstr("a place inside one"));
}

TEST_F(ObstacleCourse, IsForPoliciesThatAvoidObstacles) {
  enter("non_cooperative");
  EXPECT_EQ(check(), "") << "there are none";
  add("[[-1, -1], [1, -1], [1, 1], [-1, 1]]");
  EXPECT_EQ(check(),
            "evaluate: --policy: expected a policy that avoids obstacles, found non_cooperative");
}

TEST_F(ObstacleCourse, IsReadStrictly) {
  const auto errorOf = [this](const std::string& yaml) {
    return test::startupErrorOf([&] { addObstacles(evaluation_.suite, file(yaml)); });
  };
  EXPECT_THAT(errorOf("walls: []\n"), HasSubstr("course.yaml:1: walls"));
  EXPECT_THAT(errorOf("obstacles: []\n"), HasSubstr("at least one"));
  EXPECT_THAT(errorOf("obstacles:\n  - {name: a, points_m: [[0, 0], [1, 0]]}\n"),
              HasSubstr("course.yaml:2: obstacles[0].points_m: expected at least 3 corners"));
  EXPECT_THAT(errorOf("obstacles: [{name: a, points_m: [[0, 0], [1, 1], [1, 0], [0, 1]]}]\n"),
              HasSubstr("sides that touch or cross"));
  EXPECT_THAT(test::startupErrorOf([this] { addObstacles(evaluation_.suite, "/no/such.yaml"); }),
              HasSubstr("/no/such.yaml: obstacles: expected a file that can be read"));
}

TEST_F(ObstacleCourse, GeneratedCasesKeepClearOfIt) {
  GeneratorSettings settings;
  settings.obstacles = {{{-1.0, -1.0}, {2.0, -1.0}, {2.0, 1.0}, {-1.0, 1.0}}};
  for (const char* kind : {"random", "circle", "swap"}) {
    for (const TestCase& each : generateCases(kind, settings, 50, 1)) {
      ASSERT_EQ(each.obstacles.size(), 1u);
      for (const AgentSpec& agent : each.agents) {
        EXPECT_GE(core::distanceTo(each.obstacles[0], agent.start_m), agent.radius_m + 0.2) << kind;
        EXPECT_GE(core::distanceTo(each.obstacles[0], agent.goal_m), agent.radius_m + 0.2) << kind;
      }
    }
  }
}

}  // namespace
}  // namespace roundabout::learning
