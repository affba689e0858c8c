#include "logs/log_commands.h"

#include <filesystem>

#include <gmock/gmock.h>

#include "common/bus/messages.h"
#include "common/core/error.h"
#include "tests/logs/log_writer.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::HasSubstr;

class LogCommandsTest : public testing::Test {
 protected:
  LogCommandsTest() {
    showcase().write(log());
    addLogCommands(app_);
  }

  std::string log() const { return folder_.file("flight.lcm"); }

  /// Returns what was printed.
  std::string run(std::vector<std::string> arguments) {
    testing::internal::CaptureStdout();
    std::reverse(arguments.begin(), arguments.end());
    app_.parse(std::move(arguments));
    std::fflush(stdout);
    return testing::internal::GetCapturedStdout();
  }

  test::ScratchFolder folder_;
  CLI::App app_;
};

TEST_F(LogCommandsTest, InfoListsChannels) {
  EXPECT_THAT(run({"log", "info", log()}),
              HasSubstr("VEHICLE_STATES             vehicle_states_t"));
}

TEST_F(LogCommandsTest, MetricsPrintsASummaryAndWritesJson) {
  const std::string text = run({"log", "metrics", log(), "--json", folder_.file("metrics.json")});
  EXPECT_THAT(text, HasSubstr("2 of 2 formations formed"));
  EXPECT_TRUE(std::filesystem::exists(folder_.file("metrics.json")));
}

TEST_F(LogCommandsTest, PlotLeavesPicturesAndAReport) {
  run({"log", "plot", log(), "-o", folder_.file("out")});
  EXPECT_TRUE(std::filesystem::exists(folder_.file("out/report.html")));
  EXPECT_TRUE(std::filesystem::exists(folder_.file("out/formation_01_C.png")));
}

TEST_F(LogCommandsTest, PlotOfALogWithoutStatesIsAReportWithoutPictures) {
  {
    LogWriter writer(log());
    writer.write(1, "SAFETY_ORDER", bus::toMessage(core::SafetyOrder{}));
  }
  for (int again = 0; again < 2; ++again) {
    EXPECT_THAT(run({"log", "plot", log(), "-o", folder_.file("new/out")}),
                HasSubstr("0 pictures and "));
    EXPECT_TRUE(std::filesystem::exists(folder_.file("new/out/report.html")));
  }
}

TEST_F(LogCommandsTest, AMissingLogIsOneLine) {
  EXPECT_THROW(app_.parse("log info " + folder_.file("nowhere"), false), core::StartupError);
}

}  // namespace
}  // namespace roundabout::logs
