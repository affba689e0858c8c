#include "cli/flight_folder.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::cli {
namespace {

class FlightFolderTest : public testing::Test {
 protected:
  FlightFolderTest() : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(scratch_.path());
    experiment_ = config::parseExperiment(
        "name: swap\nseed: 7\nvehicles:\n  - {name: hex1}\nmission: [land]\n", "test");
  }
  ~FlightFolderTest() override { std::filesystem::current_path(before_); }

  test::ScratchFolder scratch_;
  std::filesystem::path before_;
  config::Experiment experiment_;
};

TEST_F(FlightFolderTest, LiesInOutAndIsNamedAfterExperimentAndTime) {
  const std::filesystem::path folder = makeFlightFolder(experiment_, "");
  EXPECT_TRUE(folder.is_absolute());
  EXPECT_EQ(folder.parent_path(), std::filesystem::current_path() / "out");
  EXPECT_THAT(folder.filename().string(), testing::MatchesRegex("swap-[0-9]+-[0-9]+"));
}

TEST_F(FlightFolderTest, IsANewOneForEveryFlight) {
  EXPECT_NE(makeFlightFolder(experiment_, ""), makeFlightFolder(experiment_, ""));
}

TEST_F(FlightFolderTest, HoldsTheResolvedExperiment) {
  const std::filesystem::path folder = makeFlightFolder(experiment_, "here");
  const config::Experiment read = config::readExperiment((folder / "experiment.yaml").string());
  EXPECT_EQ(read.seed, 7U);
  EXPECT_EQ(config::toYaml(read), config::toYaml(experiment_));
}

TEST_F(FlightFolderTest, IsNotOneThatHasFilesAlready) {
  std::filesystem::create_directory("taken");
  std::ofstream("taken/flight.lcm") << "precious";
  EXPECT_THROW(makeFlightFolder(experiment_, "taken"), core::StartupError);
}

TEST_F(FlightFolderTest, IsRefusedWhereItCannotBeMade) {
  std::ofstream("file") << "not a folder";
  EXPECT_THROW(makeFlightFolder(experiment_, "file/below"), core::StartupError);
}

}  // namespace
}  // namespace roundabout::cli
