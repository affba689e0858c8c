#include "learning/evaluation/evaluation.h"

#include <atomic>

#include <gtest/gtest.h>

#include "learning/evaluation/generate.h"
#include "planner/policies/table.h"

namespace roundabout::learning {
namespace {

Evaluation smallEvaluation() {
  Evaluation evaluation;
  evaluation.rules = makeRules("published");
  for (const char* name : {"orca", "non_cooperative"}) {
    planner::PolicyOptions options;
    options.orca = evaluation.rules.orca;
    evaluation.contestants.push_back({name, planner::makePolicy(name, options), false});
  }
  for (const int agents : {2, 5}) {
    GeneratorSettings settings;
    settings.agents = agents;
    evaluation.suite.groups.push_back({"", generateCases("mixed", settings, 20, 1)});
  }
  return evaluation;
}

struct Row {
  std::size_t number;
  Outcome outcome;
  int steps;
  double closest_m;

  bool operator==(const Row&) const = default;
};

std::vector<Row> rowsOf(const Evaluation& evaluation, int threads, std::size_t first = 0) {
  std::vector<Row> rows;
  const bool whole = runAll(
      evaluation, first, threads,
      [&](std::size_t row, const EpisodeResult& result) {
        rows.push_back({row, result.outcome, result.steps, result.closest_separation_m});
      },
      [] { return true; });
  EXPECT_TRUE(whole);
  return rows;
}

TEST(Evaluation, PlacesCountThroughContestantsGroupsAndCases) {
  const Evaluation evaluation = smallEvaluation();
  EXPECT_EQ(evaluation.cases(), 80u);
  const Place place = placeOf(evaluation, 40 + 20 + 3);
  EXPECT_EQ(place.contestant, 1u);
  EXPECT_EQ(place.group, 1u);
  EXPECT_EQ(place.number, 3u);
}

TEST(Evaluation, RowsComeInOrderAndDoNotDependOnTheThreads) {
  const Evaluation evaluation = smallEvaluation();
  const std::vector<Row> one = rowsOf(evaluation, 1);
  ASSERT_EQ(one.size(), 80u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].number, i);
  }
  EXPECT_EQ(rowsOf(evaluation, 4), one);
  EXPECT_EQ(rowsOf(evaluation, 3, 50), std::vector<Row>(one.begin() + 50, one.end()));
}

TEST(Evaluation, StopsWhenAskedAndPassesOnWholeRowsOnly) {
  const Evaluation evaluation = smallEvaluation();
  std::atomic<int> asked = 0;
  std::size_t rows = 0;
  EXPECT_FALSE(runAll(
      evaluation, 0, 2, [&](std::size_t row, const EpisodeResult&) { EXPECT_EQ(row, rows++); },
      [&] { return ++asked < 10; }));
  EXPECT_LT(rows, 20u);
}

TEST(Evaluation, AnErrorInAThreadReachesTheCaller) {
  const Evaluation evaluation = smallEvaluation();
  EXPECT_THROW(runAll(
                   evaluation, 0, 2,
                   [](std::size_t, const EpisodeResult&) { throw std::runtime_error("disk full"); },
                   [] { return true; }),
               std::runtime_error);
}

TEST(Evaluation, AMixedCrowdHasItsShareOfOthers) {
  Evaluation evaluation = smallEvaluation();
  evaluation.contestants.erase(evaluation.contestants.begin() + 1);  // ORCA is left
  const std::vector<Row> pure = rowsOf(evaluation, 1);
  evaluation.mix.emplace(
      Mix{{"non_cooperative", planner::makePolicy("non_cooperative", {})}, 0.0, 1});
  EXPECT_EQ(rowsOf(evaluation, 1), pure);
  evaluation.mix->share = 1.0;
  Evaluation others = smallEvaluation();
  others.contestants.erase(others.contestants.begin());
  EXPECT_EQ(rowsOf(evaluation, 1), rowsOf(others, 1));
  evaluation.mix->share = 0.4;
  const std::vector<Row> mixed = rowsOf(evaluation, 1);
  EXPECT_NE(mixed, pure);
  EXPECT_EQ(mixed, rowsOf(evaluation, 3));
}

}  // namespace
}  // namespace roundabout::learning
