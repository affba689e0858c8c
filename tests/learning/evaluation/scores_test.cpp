#include "learning/evaluation/scores.h"

#include <gtest/gtest.h>

#include "learning/evaluation/generate.h"
#include "learning/evaluation/summary.h"

namespace roundabout::learning {
namespace {

TEST(Percentile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(percentile({4.0, 1.0, 3.0, 2.0}, 75.0), 3.25);
  EXPECT_DOUBLE_EQ(percentile({4.0, 1.0, 3.0, 2.0}, 100.0), 4.0);
  EXPECT_DOUBLE_EQ(percentile({7.0}, 90.0), 7.0);
  EXPECT_TRUE(std::isnan(percentile({}, 90.0)));
}

EpisodeResult result(Outcome outcome, double extra_s, double closest_m) {
  return {outcome, 10, extra_s, closest_m, 0};
}

class ScoresTest : public ::testing::Test {
 protected:
  ScoresTest() {
    evaluation_.contestants.resize(2);
    evaluation_.contestants[0].specification = "orca";
    evaluation_.contestants[1].specification = "ga3c_cadrl:/a/b/net.safetensors";
    evaluation_.suite.groups = {{"pairs", std::vector<TestCase>(4, circleCase(2, 3.0))}};
    evaluation_.rules = makeRules("published");
    results_ = {result(Outcome::kAllAtGoal, 1.0, 0.5),  result(Outcome::kAllAtGoal, 3.0, 0.2),
                result(Outcome::kCollision, 9.0, -0.1), result(Outcome::kStuck, 9.0, 0.4),
                result(Outcome::kAllAtGoal, 2.0, 0.5),  result(Outcome::kStuck, 9.0, 0.3),
                result(Outcome::kAllAtGoal, 4.0, 0.3),  result(Outcome::kAllAtGoal, 6.0, 0.1)};
  }

  Evaluation evaluation_;
  std::vector<EpisodeResult> results_;
};

TEST_F(ScoresTest, CountOutcomesAndAverageSuccessesOnly) {
  const std::vector<Score> scores = scoresOf(evaluation_, results_);
  ASSERT_EQ(scores.size(), 2u);
  EXPECT_DOUBLE_EQ(scores[0].success_share, 0.5);
  EXPECT_DOUBLE_EQ(scores[0].collision_share, 0.25);
  EXPECT_DOUBLE_EQ(scores[0].stuck_share, 0.25);
  EXPECT_DOUBLE_EQ(scores[0].own.mean_s, 2.0);
  EXPECT_DOUBLE_EQ(scores[0].closest_separation_m, -0.1);
  EXPECT_DOUBLE_EQ(scores[0].mean_closest_separation_m, 0.25);
  EXPECT_DOUBLE_EQ(scores[1].own.mean_s, 4.0);
  EXPECT_EQ(scores[1].own.cases, 3u);
}

TEST_F(ScoresTest, CommonTimesAreOverTheCasesThatAllSolved) {
  const std::vector<Score> scores = scoresOf(evaluation_, results_);
  EXPECT_EQ(scores[0].common.cases, 1u);
  EXPECT_DOUBLE_EQ(scores[0].common.mean_s, 1.0);
  EXPECT_DOUBLE_EQ(scores[1].common.mean_s, 2.0);
}

TEST_F(ScoresTest, TheSummaryNamesPoliciesFiguresAndRules) {
  const std::string text = summaryText(evaluation_, scoresOf(evaluation_, results_));
  for (const char* part : {"ga3c_cadrl (net)", "75.0", "4.000 / 5.000 / 5.600", "within 0.2 m",
                           "8 times that", "radii times 1.05"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  const auto json = summaryJson(evaluation_, scoresOf(evaluation_, results_));
  EXPECT_DOUBLE_EQ(json["scores"][1]["extra_time_s"]["mean"], 4.0);
}

}  // namespace
}  // namespace roundabout::learning
