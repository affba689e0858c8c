#include "learning/evaluation/generate.h"

#include <gtest/gtest.h>

#include "learning/evaluation/suites.h"
#include "tests/support/startup_error.h"

namespace roundabout::learning {
namespace {

std::string textOf(const std::vector<TestCase>& cases) {
  std::ostringstream text;
  for (const TestCase& each : cases) {
    for (const AgentSpec& agent : each.agents) {
      text << agent.start_m.transpose() << ' ' << agent.goal_m.transpose() << ' ' << agent.radius_m
           << ' ' << agent.preferred_speed_mps << '\n';
    }
  }
  return text.str();
}

class Generated : public ::testing::TestWithParam<std::string> {};

TEST_P(Generated, CasesKeepTheirGapsAtStartAndGoals) {
  for (const int agents : {2, 5, 10}) {
    GeneratorSettings settings;
    settings.agents = agents;
    for (const TestCase& each : generateCases(GetParam(), settings, 50, 3)) {
      ASSERT_EQ(each.agents.size(), static_cast<std::size_t>(agents));
      for (std::size_t i = 0; i < each.agents.size(); ++i) {
        const AgentSpec& a = each.agents[i];
        EXPECT_GE(a.radius_m, 0.2);
        EXPECT_LE(a.radius_m, 0.8);
        EXPECT_GE(a.preferred_speed_mps, 0.5);
        EXPECT_LE(a.preferred_speed_mps, 1.5);
        for (std::size_t j = 0; j < i && GetParam() != "swap"; ++j) {
          const AgentSpec& b = each.agents[j];
          const double apart_m = a.radius_m + b.radius_m + 0.2;
          EXPECT_GE((a.start_m - b.start_m).norm(), apart_m - 1e-9);
          EXPECT_GE((a.goal_m - b.goal_m).norm(), apart_m - 1e-9);
        }
      }
    }
  }
}

TEST_P(Generated, CasesAreAFunctionOfSeedAndNumber) {
  const GeneratorSettings settings;
  const auto few = generateCases(GetParam(), settings, 3, 7);
  const auto many = generateCases(GetParam(), settings, 10, 7);
  EXPECT_EQ(textOf(few), textOf({many.begin(), many.begin() + 3}));
  EXPECT_NE(textOf(few), textOf(generateCases(GetParam(), settings, 3, 8)));
}

TEST(Generate, CasesStayWithinTheGrowthThatIsAllowed) {
  GeneratorSettings settings;
  settings.agents = 10;
  const auto farthest = [&] {
    double farthest_m = 0.0;
    for (const TestCase& each : generateCases("random", settings, 100, 5)) {
      for (const AgentSpec& agent : each.agents) {
        farthest_m = std::max(farthest_m, agent.goal_m.cwiseAbs().maxCoeff());
      }
    }
    return farthest_m;
  };
  const double unbounded_m = farthest();
  settings.max_growth = 1.4;
  EXPECT_LE(farthest(), 1.4 * settings.half_side_m);
  EXPECT_GT(unbounded_m, 1.4 * settings.half_side_m);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Generated, ::testing::Values("mixed", "random", "circle", "swap"));

TEST(Generate, RandomAgentsMeetOnTheirStraightWays) {
  GeneratorSettings settings;
  settings.agents = 2;
  int met = 0;
  for (const TestCase& each : generateCases("random", settings, 100, 1)) {
    double closest_m = 1e9;
    for (double time_s = 0.0; time_s < 30.0; time_s += 0.02) {
      const auto at = [&](const AgentSpec& agent) -> Eigen::Vector2d {
        const Eigen::Vector2d way = agent.goal_m - agent.start_m;
        const double share = std::min(1.0, time_s * agent.preferred_speed_mps / way.norm());
        return agent.start_m + share * way;
      };
      closest_m = std::min(closest_m, (at(each.agents[0]) - at(each.agents[1])).norm());
    }
    met += closest_m <= each.agents[0].radius_m + each.agents[1].radius_m + 0.21 ? 1 : 0;
  }
  EXPECT_EQ(met, 100);
}

TEST(Generate, UnknownKindsAndImpossibleSettingsAreNamed) {
  EXPECT_NE(test::startupErrorOf([] { generateCases("ring", {}, 1, 1); }).find("\"ring\""),
            std::string::npos);
}

TEST(Suites, EveryOneHasCasesThatBeginApart) {
  for (const SuiteEntry& entry : suiteTable()) {
    if (entry.name == "random500") {
      continue;  // its generator is tested above
    }
    const Suite suite = makeSuite(std::string(entry.name));
    EXPECT_FALSE(suite.groups.empty()) << entry.name;
    for (const CaseGroup& group : suite.groups) {
      ASSERT_FALSE(group.cases.empty()) << group.name;
      for (const TestCase& each : group.cases) {
        for (std::size_t i = 0; i < each.agents.size(); ++i) {
          for (std::size_t j = 0; j < i; ++j) {
            EXPECT_GT((each.agents[i].start_m - each.agents[j].start_m).norm(),
                      each.agents[i].radius_m + each.agents[j].radius_m)
                << entry.name << ", " << group.name;
          }
        }
      }
    }
  }
}

TEST(Suites, AnUnknownOneIsRefusedWithThoseThereAre) {
  const std::string error = test::startupErrorOf([] { makeSuite("random50"); });
  EXPECT_NE(error.find("random500, table1"), std::string::npos) << error;
}

}  // namespace
}  // namespace roundabout::learning
