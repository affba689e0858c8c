// Against what the published environment's own code did with the published policies, case by case
// (reference/outcomes).

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "learning/evaluation/case_file.h"
#include "learning/evaluation/scores.h"
#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/policies/table.h"
#include "planner/policy_tools/import_checkpoint.h"
#include "tests/support/reference.h"

namespace roundabout::learning {
namespace {

struct Published {
  std::string outcome;
  int steps;
  double mean_extra_time_s;
};

class PublishedOutcomes : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(test::referenceFolder() / "outcomes")) {
      GTEST_SKIP() << "no published outcomes in " << test::referenceFolder();
    }
    evaluation_.rules = makeRules("published");
    evaluation_.suite.groups = readCaseFile(test::referenceFolder() / "test_cases" /
                                            fmt::format("{}_agents_500_cases.csv", GetParam()));
  }

  std::vector<EpisodeResult> run(std::unique_ptr<planner::Policy> policy) {
    evaluation_.contestants.clear();
    evaluation_.contestants.push_back({std::string(policy->name()), std::move(policy)});
    std::vector<EpisodeResult> results;
    runAll(
        evaluation_, 0, 2,
        [&](std::size_t, const EpisodeResult& result) { results.push_back(result); },
        [] { return true; });
    return results;
  }

  static std::vector<Published> published(const std::string& policy) {
    std::ifstream file(test::referenceFolder() / "outcomes" /
                       fmt::format("{}_{}_agents.csv", policy, GetParam()));
    std::vector<Published> rows;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream cells(line);
      Published row;
      std::string cell;
      std::getline(cells, cell, ',');
      std::getline(cells, row.outcome, ',');
      char comma = 0;
      cells >> row.steps >> comma >> row.mean_extra_time_s;
      rows.push_back(row);
    }
    return rows;
  }

  Evaluation evaluation_;
};

TEST_P(PublishedOutcomes, TheNetworkEndsEveryCaseTheSameWayAtTheSameTime) {
  const std::string prefix =
      test::referenceFolder() / "ga3c_cadrl/checkpoints/gym_IROS18_01900000/network_01900000";
  const auto results = run(std::make_unique<planner::Ga3cCadrl>(
      planner::toGa3cCadrlWeights(planner::importCheckpoint(prefix), prefix)));
  const std::vector<Published> expected = published("IROS18");
  ASSERT_EQ(results.size(), expected.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(nameOf(results[i].outcome), expected[i].outcome) << "case " << i;
    EXPECT_EQ(results[i].steps, expected[i].steps) << "case " << i;
    EXPECT_NEAR(results[i].mean_extra_time_s, expected[i].mean_extra_time_s, 0.002) << "case " << i;
  }
}

// RVO2 calculates in single precision: steps differ in the last digits, and what they add up to in
// a few cases.
TEST_P(PublishedOutcomes, OrcaScoresTheSame) {
  planner::PolicyOptions options;
  options.orca = evaluation_.rules.orca;
  const auto results = run(planner::makePolicy("orca", options));
  const std::vector<Published> expected = published("ORCA");
  const Score score = scoresOf(evaluation_, results).front();
  double successes = 0.0;
  double extra_time_s = 0.0;
  int other_outcome = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    other_outcome += expected[i].outcome != nameOf(results[i].outcome) ? 1 : 0;
    if (expected[i].outcome == "all_at_goal") {
      successes += 1.0;
      extra_time_s += expected[i].mean_extra_time_s;
    }
  }
  EXPECT_LE(other_outcome, 5);
  EXPECT_NEAR(score.success_share, successes / 500.0, 0.02);
  EXPECT_NEAR(score.own.mean_s, extra_time_s / successes, 0.05 * extra_time_s / successes);
}

INSTANTIATE_TEST_SUITE_P(Agents, PublishedOutcomes, ::testing::Values(2, 3, 4, 6),
                         [](const auto& agents) { return std::to_string(agents.param); });

}  // namespace
}  // namespace roundabout::learning
