// Sweeps to points, segments and poses.

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "perception/pose_history.h"
#include "perception/scan/scan_gate.h"
#include "perception/scan/segments.h"

namespace roundabout::perception {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

core::LaserScan scanOf(std::vector<float> ranges_m, core::Utime utime = 1'000'000) {
  return {utime, -0.5, 0.01, std::move(ranges_m)};
}

TEST(ScanPoints, LieWhereTheBeamsEndedWhileTheVehicleTurned) {
  ScanPoints points;
  const PlanarPose begin{{0.0, 0.0}, 0.0};
  const PlanarPose end{{1.0, 0.0}, 0.2};
  const core::LaserScan scan{1'000'000, 0.0, 0.1, {2.0F, 2.0F, 2.0F}};
  EXPECT_EQ(toPoints(scan, begin, end, {}, points), 0);
  EXPECT_TRUE(points.world_m[0].isApprox(Eigen::Vector2d(2.0, 0.0)));
  EXPECT_TRUE(
      points.world_m[1].isApprox(Eigen::Vector2d(0.5 + 2.0 * std::cos(0.2), 2.0 * std::sin(0.2))));
  EXPECT_TRUE(
      points.world_m[2].isApprox(Eigen::Vector2d(1.0 + 2.0 * std::cos(0.4), 2.0 * std::sin(0.4))));
}

TEST(ScanPoints, FindTheBeamOfADirection) {
  ScanPoints points;
  const core::LaserScan scan{0, -0.5, 0.01, std::vector<float>(101, 1.0F)};
  toPoints(scan, {{0.0, 0.0}, 3.0}, {{0.0, 0.0}, 3.0}, {}, points);
  EXPECT_EQ(points.beamAt(3.0), 50U);
  EXPECT_EQ(points.beamAt(3.0 - 2.0 * std::numbers::pi), 50U);
  EXPECT_EQ(points.beamAt(2.5), 0U);
  EXPECT_EQ(points.beamAt(3.5), 100U);
  EXPECT_EQ(points.beamAt(3.6), points.size());
  EXPECT_EQ(points.beamAt(0.0), points.size());
}

TEST(ScanPoints, CountWhatIsNoRange) {
  ScanPoints points;
  EXPECT_EQ(toPoints(scanOf({kNan, -1.0F, -kInfinity, kInfinity, 20.0F, 2.0F}), {}, {}, {}, points),
            3);
  EXPECT_EQ(std::count(points.hit.begin(), points.hit.end(), 1), 1);
  EXPECT_EQ(points.hit.back(), 1);
}

TEST(Segments, EndWhereTheNextSurfaceBegins) {
  ScanPoints points;
  std::vector<float> ranges(60, 3.0F);
  std::fill(ranges.begin() + 20, ranges.begin() + 30, 1.0F);
  ranges[25] = kNan;  // one beam without an echo does not divide a leg
  ranges[45] = 1.9F;  // half on an edge
  toPoints(scanOf(ranges), {}, {}, {}, points);
  std::vector<Segment> segments;
  findSegments(points, {}, segments);
  ASSERT_EQ(segments.size(), 3U);
  EXPECT_EQ(segments[1].beams.size(), 9U);
  EXPECT_NEAR(segments[1].width_m, 0.09, 0.005);
  EXPECT_FALSE(segments[1].hidden_begin || segments[1].hidden_end);
  EXPECT_TRUE(segments[0].hidden_begin);  // by the edge of the field of view
  EXPECT_TRUE(segments[0].hidden_end);
  EXPECT_TRUE(segments[2].hidden_begin);
}

TEST(Segments, GoOnOverTheSeamOfAFullCircle) {
  ScanPoints points;
  core::LaserScan scan{0, -std::numbers::pi, 2.0 * std::numbers::pi / 360.0,
                       std::vector<float>(360, kInfinity)};
  for (const std::size_t beam : {358U, 359U, 0U, 1U}) {
    scan.ranges_m[beam] = 2.0F;
  }
  toPoints(scan, {}, {}, {}, points);
  std::vector<Segment> segments;
  findSegments(points, {}, segments);
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(segments[0].beams, (std::vector<std::size_t>{358, 359, 0, 1}));
}

TEST(Segments, AreLegsOrAWall) {
  ScanPoints points;
  std::vector<float> ranges(60, kInfinity);
  for (const std::size_t leg : {10U, 14U, 30U, 34U}) {  // 0.02 x 8 m = 16 cm between two beams
    ranges[leg] = ranges[leg + 1] = 8.0F;
  }
  core::LaserScan scan = scanOf(ranges);
  toPoints(scan, {}, {}, {}, points);
  Segment crowd;
  crowd.beams = {10, 11, 14, 15, 30, 31, 34, 35};
  EXPECT_EQ(legsOf(points, crowd, 0.32).size(), 4U);
  std::fill(ranges.begin(), ranges.end(), 8.0F);
  toPoints(scanOf(ranges), {}, {}, {}, points);
  Segment wall;
  for (std::size_t i = 0; i < 60; ++i) {
    wall.beams.push_back(i);
  }
  EXPECT_TRUE(legsOf(points, wall, 0.32).empty());
}

TEST(ScanGate, RefusesWhatNoSweepIs) {
  ScanGate gate;
  EXPECT_EQ(gate.judge(scanOf(std::vector<float>(100, 2.0F), 1'000'000)), nullptr);
  EXPECT_STREQ(gate.judge(scanOf({}, 1'025'000)), "fewer than two ranges");
  EXPECT_STREQ(gate.judge(scanOf(std::vector<float>(99, 2.0F), 1'025'000)),
               "another number of ranges than before");
  EXPECT_STREQ(gate.judge(scanOf(std::vector<float>(100, kNan), 1'025'000)),
               "fewer than half of the ranges usable");
  EXPECT_STREQ(gate.judge(scanOf(std::vector<float>(100, 2.0F), 900'000)),
               "its time stamp is old, or corrupt");
  core::LaserScan turned = scanOf(std::vector<float>(100, 2.0F), 1'025'000);
  turned.angle_step_rad = 1.0;
  EXPECT_STREQ(gate.judge(turned), "angles that no lidar has");
  EXPECT_EQ(gate.judge(scanOf(std::vector<float>(100, kInfinity), 1'025'000)), nullptr);
}

TEST(ScanGate, BelievesAnotherLidarAfterTenSweeps) {
  ScanGate gate;
  gate.judge(scanOf(std::vector<float>(100, 2.0F), 1'000'000));
  for (int i = 1; i < 10; ++i) {
    EXPECT_NE(gate.judge(scanOf(std::vector<float>(50, 2.0F), 1'000'000 + i * 10'000)), nullptr);
  }
  EXPECT_EQ(gate.judge(scanOf(std::vector<float>(50, 2.0F), 1'100'000)), nullptr);
}

TEST(PoseHistory, GivesWhatLiesBetween) {
  PoseHistory poses({});
  poses.add(1'000'000, {{0.0, 0.0}, 3.1});
  poses.add(1'010'000, {{0.02, 0.0}, -3.1});
  const auto middle = poses.at(1'005'000);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->position_m.x(), 0.01, 1e-12);
  EXPECT_NEAR(std::cos(middle->heading_rad), -1.0, 1e-9);
  EXPECT_FALSE(poses.at(999'999));
  EXPECT_FALSE(poses.at(1'010'001));
}

TEST(PoseHistory, DoesNotBelieveAJumpBeforeTheTenth) {
  PoseHistory poses({});
  poses.add(1'000'000, {});
  for (int i = 1; i < 10; ++i) {
    EXPECT_EQ(poses.add(1'000'000 + i * 5000, {{3.0, 0.0}, 0.0}), PoseHistory::Verdict::kRejected);
  }
  EXPECT_EQ(poses.newest(), 1'000'000);
  EXPECT_EQ(poses.add(1'050'000, {{3.0, 0.0}, 0.0}), PoseHistory::Verdict::kJumped);
  EXPECT_EQ(poses.oldest(), 1'050'000);
}

}  // namespace
}  // namespace roundabout::perception
