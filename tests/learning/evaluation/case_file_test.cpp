#include "learning/evaluation/case_file.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::learning {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTitles = "case,agent,start_x,start_y,goal_x,goal_y,radius,pref_speed\n";

class CaseFile : public ::testing::Test {
 protected:
  std::string write(const std::string& text) const {
    std::ofstream(scratch_ / "cases.csv") << text;
    return (scratch_ / "cases.csv").string();
  }
  std::string errorOf(const std::string& rows) const {
    const std::string file = write(kTitles + rows);
    return test::startupErrorOf([&] { readCaseFile(file); });
  }

  test::ScratchFolder scratch_;
};

TEST_F(CaseFile, GroupsCasesBySize) {
  const auto groups = readCaseFile(write(std::string(kTitles) + "0,0,-1,0.5,3,0,0.3,1.25\n"
                                                                "1,0,0,0,1,0,0.3,1\n"
                                                                "1,1,5,0,1,0,0.4,1.5\r\n"
                                                                "2,0,0,0,2,0,0.3,1\n"));
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].name, "1 agent");
  ASSERT_EQ(groups[0].cases.size(), 2u);
  const AgentSpec& agent = groups[0].cases[0].agents[0];
  EXPECT_EQ(agent.start_m, Eigen::Vector2d(-1.0, 0.5));
  EXPECT_EQ(agent.goal_m, Eigen::Vector2d(3.0, 0.0));
  EXPECT_EQ(agent.radius_m, 0.3);
  EXPECT_EQ(agent.preferred_speed_mps, 1.25);
  EXPECT_EQ(groups[1].name, "2 agents");
  EXPECT_EQ(groups[1].cases[0].agents[1].preferred_speed_mps, 1.5);
}

TEST_F(CaseFile, IsReadAsSpreadsheetsAndPeopleWriteIt) {
  const auto groups = readCaseFile(
      write("\xef\xbb\xbf" + std::string(kTitles) + "0, 0, -1, 0.5, 3, 0, 0.3, 1.25\r\n\r\n\n"));
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].cases[0].agents[0].start_m, Eigen::Vector2d(-1.0, 0.5));
}

TEST_F(CaseFile, NamesLineAndColumnOfWhatIsWrong) {
  const std::string good = "0,0,0,0,1,0,0.3,1\n";
  EXPECT_THAT(errorOf(good + "0,1,0,x,1,0,0.3,1\n"),
              HasSubstr("cases.csv:3: start_y: expected a number, found \"x\""));
  EXPECT_THAT(errorOf(good + "0,1,0,0,1,0,0.3\n"), HasSubstr(":3: row: expected 8 columns"));
  EXPECT_THAT(errorOf(good + "0,1,0,0,1,0,-0.3,1\n"), HasSubstr(":3: radius: "));
  EXPECT_THAT(errorOf(good + "0,1,0,0,1,0,0.3,0\n"), HasSubstr(":3: pref_speed: "));
  EXPECT_THAT(errorOf(good + "0,2,0,0,1,0,0.3,1\n"), HasSubstr(":3: agent: expected 1, found 2"));
  EXPECT_THAT(errorOf(good + "3,0,0,0,1,0,0.3,1\n"), HasSubstr(":3: case: expected 1, found 3"));
  EXPECT_THAT(errorOf(good + "0,1,0,nan,1,0,0.3,1\n"), HasSubstr(":3: start_y: "));
  EXPECT_THAT(errorOf(good + "\n0,1,0,0,1,0,0.3\n"), HasSubstr(":4: row: "));
  EXPECT_THAT(errorOf(good + "0,1,0,0,1e308,0,0.3,1\n"),
              HasSubstr(":3: row: expected a goal within 3600 s"));
  EXPECT_THAT(errorOf(good + "0,1,0,0,1,0,0.3,1e-9\n"), HasSubstr("found 1e+09 s"));
}

TEST_F(CaseFile, RefusesOtherColumnsAndNothing) {
  const std::string other = write("case,agent,x\n0,0,1\n");
  EXPECT_THAT(test::startupErrorOf([&] { readCaseFile(other); }), HasSubstr(":1: columns: "));
  EXPECT_THAT(errorOf(""), HasSubstr("expected at least one agent"));
  EXPECT_THAT(test::startupErrorOf([] { readCaseFile("/no/such.csv"); }),
              HasSubstr("/no/such.csv"));
}

}  // namespace
}  // namespace roundabout::learning
