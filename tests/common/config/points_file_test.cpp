#include "common/config/points_file.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::config {
namespace {

class PointsFile : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_ / name) << text;
    return (scratch_ / name).string();
  }
  std::string errorOf(const std::string& text) const {
    try {
      readPointsFile(write("points.csv", text));
    } catch (const core::StartupError& error) {
      return error.what();
    }
    return "";
  }

  test::ScratchFolder scratch_;
};

TEST_F(PointsFile, ReadsPointsWithAndWithoutHeights) {
  const auto points = readPointsFile(write("points.csv", "# x, y\n1, 2\n\n-3.5 4 1.5  # high\n"));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_DOUBLE_EQ(points[0].y(), 2.0);
  EXPECT_TRUE(std::isnan(points[0].z()));
  EXPECT_EQ(points[1], Eigen::Vector3d(-3.5, 4.0, 1.5));
}

TEST_F(PointsFile, NamesTheLineThatIsNoPoint) {
  const std::string file = (scratch_ / "points.csv").string();
  EXPECT_EQ(errorOf("1, 2\n3\n"), file + ":2: point: expected x, y or x, y, z, found \"3\"");
  EXPECT_EQ(errorOf("1, two\n"), file + ":1: point: expected x, y or x, y, z, found \"1, two\"");
  EXPECT_EQ(errorOf("1, 2, 3, 4\n"),
            file + ":1: point: expected x, y or x, y, z, found \"1, 2, 3, 4\"");
  EXPECT_EQ(errorOf("1, nan\n"), file + ":1: point: expected x, y or x, y, z, found \"1, nan\"");
  EXPECT_EQ(errorOf("# nothing\n"),
            file + ": points_file: expected at least one point, found none");
}

TEST_F(PointsFile, BelongsToAFormationAndLiesBesideTheExperiment) {
  write("line.csv", "0, 0\n2, 0\n");
  const Experiment experiment = readExperiment(
      write("e.yaml",
            "vehicles: [{name: a, height_m: 1.2}, {name: b, height_m: 1.2}]\n"
            "mission: [take_off, {formation: {name: line, points_file: line.csv}}]\n"));
  ASSERT_EQ(experiment.mission[1].points_m.size(), 2u);
  EXPECT_EQ(experiment.mission[1].points_m[1], Eigen::Vector3d(2.0, 0.0, 1.2));
  EXPECT_EQ(parseExperiment(toYaml(experiment), "again").mission[1].points_m,
            experiment.mission[1].points_m);
}

TEST_F(PointsFile, CannotStandBesidePoints) {
  write("line.csv", "0, 0\n");
  try {
    readExperiment(write("e.yaml",
                         "vehicles: [{name: a}]\n"
                         "mission: [{formation: {points: [[0, 0]], points_file: line.csv}}]\n"));
    FAIL();
  } catch (const core::StartupError& error) {
    EXPECT_NE(std::string(error.what()).find("expected points or a points_file, found both"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace roundabout::config
