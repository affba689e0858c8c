#include "learning/evaluation/crossing/crossing.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "learning/evaluation/crossing/crossing_figure.h"
#include "planner/policies/table.h"
#include "tests/planner/occupied_cells.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::learning {
namespace {

// A robot 6 m from its goal.
config::Experiment corridor() {
  config::Experiment experiment;
  experiment.file = "test";
  config::Vehicle robot;
  robot.name = "rover";
  robot.model = "ground_robot";
  robot.preferred_speed_mps = 1.2;
  robot.assumed_radius_m = 0.3;
  robot.body_radius_m = 0.25;
  robot.height_m = 0.3;
  robot.start = config::Start{{-3.0, 0.0}, 0.0};
  robot.lidar = config::Lidar();
  robot.lidar->max_range_m = 8.0;
  experiment.vehicles = {robot};
  experiment.planner.others = "tracks";
  experiment.fleet.step_timeout_s = 25.0;
  experiment.mission = {{"formation", "across", "", {{3.0, 0.0, 0.3}}, -1.0, ""}};
  return experiment;
}

// Who hears nothing of its perception.
class NoEyes final : public Eyes {
 public:
  void onFrame(const core::StatesFrame& /*frame*/) override {}
  void onScan(const core::LaserScan& /*scan*/,
              std::span<const sim::Pedestrian> /*people*/) override {}
  std::optional<core::AgentTracks> takeTracks() override { return std::nullopt; }
};

CrossingCast cast() {
  return {trueEyes, [] { return planner::makePolicy("orca", {}); },
          [] { return std::make_unique<sim::SocialForce>(); }};
}

TEST(Crossing, AloneTheRobotArrivesInLittleMoreThanTheLeastTime) {
  const CrossingResult result = runCrossing(corridor(), cast());
  EXPECT_TRUE(result.reached);
  EXPECT_LT(result.extra_time_s, 4.0);
  EXPECT_GT(result.extra_time_s, 0.0);
  EXPECT_TRUE(std::isinf(result.closest_m));
}

TEST(Crossing, WithoutTracksItStandsAndSaysSo) {
  CrossingCast blind = cast();
  blind.eyes = [](const config::Experiment&, const std::string&) {
    return std::make_unique<NoEyes>();
  };
  config::Experiment experiment = corridor();
  experiment.fleet.step_timeout_s = 5.0;
  const CrossingResult result = runCrossing(experiment, blind);
  EXPECT_FALSE(result.reached);
  EXPECT_GT(result.ticks_blind, 40);
}

TEST(Crossing, GoesRoundWhoStandsInTheWayAndIsTheSameEveryTime) {
  config::Experiment experiment = corridor();
  experiment.pedestrians.count = 4;
  experiment.pedestrians.standing_share = 1.0;
  experiment.pedestrians.area = {{-1.0, -1.2}, {1.5, 1.2}};
  const CrossingResult result = runCrossing(experiment, cast());
  EXPECT_TRUE(result.reached);
  EXPECT_EQ(result.collisions_by_robot, 0);
  EXPECT_GT(result.closest_m, 0.0);
  EXPECT_LT(result.closest_m, 2.0);
  const CrossingResult again = runCrossing(experiment, cast());
  EXPECT_EQ(result.time_s, again.time_s);
  EXPECT_EQ(result.closest_m, again.closest_m);
}

// Who sees nobody, and knows a wall across the way that nobody else knows.
class MapEyes final : public Eyes {
 public:
  void onFrame(const core::StatesFrame& /*frame*/) override {}
  void onScan(const core::LaserScan& scan, std::span<const sim::Pedestrian> /*people*/) override {
    tracks_.emplace().utime = scan.utime;
    if (!said_) {
      std::vector<test::CellKey> wall;
      for (int y = -40; y < 10; ++y) {
        wall.push_back({0, y});
      }
      map_ = test::mapOf(wall);
      map_->utime = scan.utime;
      said_ = true;
    }
  }
  std::optional<core::AgentTracks> takeTracks() override {
    return std::exchange(tracks_, std::nullopt);
  }
  std::optional<core::OccupancyMap> takeMap() override { return std::exchange(map_, std::nullopt); }

 private:
  bool said_ = false;
  std::optional<core::AgentTracks> tracks_;
  std::optional<core::OccupancyMap> map_;
};

TEST(Crossing, GoesRoundWhatTheMapKnows) {
  CrossingCast knowing = cast();
  knowing.eyes = [](const config::Experiment&, const std::string&) {
    return std::make_unique<MapEyes>();
  };
  CrossingTrace trace;
  const CrossingResult result = runCrossing(corridor(), knowing, &trace);
  EXPECT_TRUE(result.reached);
  double at_wall_m = -10.0;
  for (const CrossingTrace::Moment& moment : trace.moments) {
    if (std::abs(moment.robot_m.x()) < 0.1) {
      at_wall_m = std::max(at_wall_m, moment.robot_m.y());
    }
  }
  EXPECT_GT(at_wall_m, 1.0 + corridor().vehicles.front().body_radius_m);
}

TEST(Crossing, IsRefusedWithoutALidarOrAGoal) {
  config::Experiment experiment = corridor();
  experiment.mission.clear();
  EXPECT_EQ(test::startupErrorOf([&] { runCrossing(experiment, cast()); }),
            "test: mission: expected a step with a point to drive to, found none");
  experiment = corridor();
  experiment.vehicles[0].lidar.reset();
  EXPECT_EQ(test::startupErrorOf([&] { runCrossing(experiment, cast()); }),
            "test: vehicles[0].lidar: expected one, to see people by, found none");
}

TEST(Crossing, WhatIsRefusedIsRefusedBeforeTheFirstRun) {
  config::Experiment experiment = corridor();
  EXPECT_EQ(test::startupErrorOf([&] { requireCrossing(experiment, cast()); }), "");
  experiment.vehicles[0].lidar.reset();
  EXPECT_EQ(test::startupErrorOf([&] { requireCrossing(experiment, cast()); }),
            test::startupErrorOf([&] { runCrossing(experiment, cast()); }));
  experiment = corridor();
  experiment.obstacles = {{"table", {{-1.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}}}};
  experiment.shield.on = false;
  CrossingCast learned = cast();
  learned.policy = [] { return planner::makePolicy("non_cooperative", {}); };
  EXPECT_NE(test::startupErrorOf([&] { requireCrossing(experiment, learned); }).find("obstacles"),
            std::string::npos);
}

// A trace that ends as it begins has no time to get lighter by.
TEST(CrossingFigure, DrawsARunOfNoTime) {
  const test::ScratchFolder folder;
  CrossingTrace trace;
  trace.goal_m = {0.1, 0.0};
  trace.moments = {{0.0, {0.0, 0.0}, 0.0, {{1, {1.0, 0.0}}}}};
  drawCrossing(corridor(), trace, "at its goal", folder / "run");
  std::ifstream in(folder / "run.svg");
  const std::string svg{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(svg.find("rgb(216,  92,  20)"), std::string::npos) << "the person, not lighter";
}

TEST(CrossingSummary, CountsRunsAndAveragesOverThoseThatArrived) {
  CrossingResult good;
  good.reached = true;
  good.extra_time_s = 2.0;
  good.closest_m = 0.4;
  good.ticks = 100;
  CrossingResult hit = good;
  hit.extra_time_s = 4.0;
  hit.collisions_by_robot = 2;
  hit.closest_m = -0.1;
  CrossingResult lost;
  lost.closest_m = 0.2;
  lost.ticks = 200;
  lost.ticks_blind = 40;
  const CrossingResult results[] = {good, hit, lost};
  const CrossingSummary summary = summarise(results);
  EXPECT_EQ(summary.runs, 3);
  EXPECT_EQ(summary.reached, 2);
  EXPECT_EQ(summary.runs_hit_by_robot, 1);
  EXPECT_DOUBLE_EQ(summary.mean_extra_s, 3.0);
  EXPECT_DOUBLE_EQ(summary.closest_m, -0.1);
  EXPECT_DOUBLE_EQ(summary.median_closest_m, 0.2);
  EXPECT_DOUBLE_EQ(summary.blind_share, 0.1);
}

}  // namespace
}  // namespace roundabout::learning
