#include "fleet/formations/stroke_font.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::fleet {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kBlank = "    1  1JZ";
constexpr const char* kPlus =
    "    2  6JZRFR[ RMRWR";  // from top to bottom, then from left to right

class FontFile : public ::testing::Test {
 protected:
  // The characters from the blank to '~', of which '!' is drawn as `exclamation_mark`.
  std::string write(const std::string& exclamation_mark, int characters = 95) const {
    std::ofstream out(scratch_ / "test.jhf");
    for (int i = 0; i < characters; ++i) {
      out << (i == 1 ? exclamation_mark : kBlank) << '\n';
    }
    return (scratch_ / "test.jhf").string();
  }
  std::string errorOf(const std::string& exclamation_mark, int characters = 95) const {
    const std::string file = write(exclamation_mark, characters);
    return test::startupErrorOf([&] { StrokeFont font(file); });
  }

  test::ScratchFolder scratch_;
};

TEST_F(FontFile, GivesStrokesFromTheBaselineUpInUnitsOfACapital) {
  const StrokeFont font(write(kPlus));
  ASSERT_TRUE(font.has('!'));
  const std::vector<Stroke>& strokes = font.strokes('!');
  ASSERT_EQ(strokes.size(), 2u);
  ASSERT_EQ(strokes[0].size(), 2u);
  EXPECT_TRUE(strokes[0][0].isApprox(Eigen::Vector2d(0.0, 1.0)));
  EXPECT_TRUE(strokes[0][1].isZero());
  EXPECT_TRUE(strokes[1][0].isApprox(Eigen::Vector2d(-5.0, 9.0) / 21.0));
  EXPECT_TRUE(strokes[1][1].isApprox(Eigen::Vector2d(5.0, 9.0) / 21.0));
  EXPECT_FALSE(font.has('A'));
}

TEST_F(FontFile, NamesTheLineThatIsShorterOrLongerThanItSays) {
  for (const char* line : {"    2  7JZRFR[ RMRWR", "    2  5JZRFR[ RMRWR", "    2  6JZRFR[ RMRW"}) {
    EXPECT_THAT(errorOf(line), AllOf(HasSubstr("test.jhf: line 2: "), HasSubstr(line)));
  }
}

TEST_F(FontFile, NamesTheLineWithoutAPairCount) {
  for (const char* line :
       {"", "    2", "    2   RFR[", "    2 -1", "    2 x6JZRFR[ RMRWR", "    2  0", "    2  "}) {
    EXPECT_THAT(errorOf(line), HasSubstr("test.jhf: line 2: ")) << line;
  }
}

TEST_F(FontFile, NamesTheFirstLetterThatIsNotThere) {
  EXPECT_THAT(errorOf(kPlus, 40), AllOf(HasSubstr("line 41"), HasSubstr("'H'")));
}

TEST(StrokeFont, HasEveryPrintableCharacter) {
  const StrokeFont font;
  for (char character = '!'; character <= '~'; ++character) {
    EXPECT_TRUE(font.has(character)) << character;
  }
  EXPECT_FALSE(font.has(' '));
  EXPECT_FALSE(font.has('\n'));
}

TEST(StrokeFont, ACapitalIsOneUnitHigh) {
  const StrokeFont font;
  double low = 10.0;
  double high = -10.0;
  for (const Stroke& stroke : font.strokes('H')) {
    for (const Eigen::Vector2d& point : stroke) {
      low = std::min(low, point.y());
      high = std::max(high, point.y());
    }
  }
  EXPECT_NEAR(high - low, 1.0, 1e-9);
}

TEST(StrokeFont, NamesThePackageWhenItIsMissing) {
  EXPECT_THAT(test::startupErrorOf([] { StrokeFont font("/nowhere/futural.jhf"); }),
              HasSubstr("hershey-fonts-data"));
}

}  // namespace
}  // namespace roundabout::fleet
