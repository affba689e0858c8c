#include "learning/evaluation/results_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "learning/evaluation/generate.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::learning {
namespace {

using ::testing::HasSubstr;

class ResultsFolderTest : public ::testing::Test {
 protected:
  ResultsFolderTest() {
    evaluation_.contestants.resize(1);
    evaluation_.contestants[0].specification = "ga3c_cadrl:/odd, path/net.safetensors";
    evaluation_.suite.groups = {{"a, b", std::vector<TestCase>(4, circleCase(3, 3.0))}};
  }

  ResultsFolder open(bool resume, const char* run = "this") {
    return ResultsFolder(folder(), {{"run", run}}, resume, evaluation_);
  }
  std::filesystem::path folder() const { return scratch_ / "out"; }
  void append(const std::string& text) const {
    std::ofstream(folder() / "cases.csv", std::ios::app) << text;
  }
  std::string errorOf(bool resume, const char* run = "this") {
    return test::startupErrorOf([&] { open(resume, run); });
  }
  static EpisodeResult result(double extra_s) {
    return {Outcome::kCollision, 17, extra_s, -0.25, 40, {30, 1, 2, 3, 4, 0}};
  }

  test::ScratchFolder scratch_;
  Evaluation evaluation_;
};

TEST_F(ResultsFolderTest, RowsAreReadBackToGoOn) {
  {
    ResultsFolder results = open(false);
    results.append(evaluation_, 0, result(1.23456789));
    results.append(evaluation_, 1, result(std::numeric_limits<double>::quiet_NaN()));
  }
  ResultsFolder results = open(true);
  ASSERT_EQ(results.finished().size(), 2u);
  EXPECT_EQ(results.finished()[0].outcome, Outcome::kCollision);
  EXPECT_EQ(results.finished()[0].steps, 17);
  EXPECT_EQ(results.finished()[0].mean_extra_time_s, 1.234568);
  EXPECT_EQ(results.finished()[0].closest_separation_m, -0.25);
  EXPECT_EQ(results.finished()[0].decisions, 40);
  EXPECT_EQ(results.finished()[0].layers, (std::array<long, kShieldLayers>{0, 1, 2, 3, 4, 0}));
  EXPECT_TRUE(std::isnan(results.finished()[1].mean_extra_time_s));
}

TEST_F(ResultsFolderTest, ARowThatWasBeingWrittenIsDroppedAndWrittenAgain) {
  open(false).append(evaluation_, 0, result(1.0));
  append("\"ga3c_cadrl:/odd, path/net.safetensors\",3,1,coll");
  {
    ResultsFolder results = open(true);
    EXPECT_EQ(results.finished().size(), 1u);
    results.append(evaluation_, 1, result(2.0));
  }
  EXPECT_EQ(open(true).finished().size(), 2u);
}

TEST_F(ResultsFolderTest, RefusesAFolderWithFilesAndAnotherRunsFolder) {
  open(false);
  EXPECT_THAT(errorOf(false), HasSubstr("expected a folder that is new or empty"));
  EXPECT_THAT(errorOf(true, "other"), HasSubstr("run.json: --resume: expected the run"));
}

TEST_F(ResultsFolderTest, BeginsAnewWhereEvenTheTitlesWereCut) {
  open(false);
  for (const std::uintmax_t left : {0u, 10u}) {
    std::filesystem::resize_file(folder() / "cases.csv", left);
    open(true).append(evaluation_, 0, result(1.0));
    EXPECT_EQ(open(true).finished().size(), 1u) << left;
  }
  std::filesystem::remove(folder() / "cases.csv");
  EXPECT_EQ(open(true).finished().size(), 0u);
}

TEST_F(ResultsFolderTest, NamesTheRowThatIsNoneOfThisRun) {
  open(false).append(evaluation_, 0, result(1.0));
  append("orca,3,1,collision,1,1,1,x\n");
  EXPECT_THAT(errorOf(true), HasSubstr("cases.csv:3: row: "));
}

}  // namespace
}  // namespace roundabout::learning
