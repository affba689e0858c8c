#include "common/plot/gnuplot_script.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/error.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::plot {
namespace {

using testing::HasSubstr;

TEST(GnuplotScript, QuotesWhatGnuplotSays) {
  GnuplotScript script;
  script.line("set nonsense");
  try {
    script.run();
    FAIL() << "nonsense was accepted";
  } catch (const core::StartupError& error) {
    EXPECT_THAT(error.what(), HasSubstr("gnuplot: figures: expected a script that runs"));
    EXPECT_THAT(error.what(), HasSubstr("nrecognized option"));
  }
}

TEST(GnuplotScript, QuotesTextSoThatNothingIsInterpreted) {
  EXPECT_EQ(gnuplotString("a\"b\\c\nd`e`"), "\"a\\\"b\\\\c d\\`e\\`\"");
}

TEST(GnuplotScript, DrawsIntoAFileOfAnyName) {
  const test::ScratchFolder folder;
  const std::filesystem::path file = folder / "it's \"here\"; $(touch x).svg";
  GnuplotScript script;
  script.data("data", {"0 0", "1 1"});
  script.line("set term svg");
  script.line("set output {}", gnuplotString(file.string()));
  script.line("plot $data");
  script.line("set output");
  script.run();
  EXPECT_TRUE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace roundabout::plot
