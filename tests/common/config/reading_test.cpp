#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::config {
namespace {

constexpr const char* kTwoVehicles = "vehicles: [{name: hex1}, {name: hex2}]\n";

Experiment withTwo(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return parseExperiment(kTwoVehicles + yaml, "lab.yaml", overrides);
}

TEST(VehicleDefaults, ApplyBeforeAVehiclesOwnKeys) {
  const Experiment read = parseExperiment(
      "vehicle_defaults: {height_m: 1.5, body_radius_m: 0.2}\n"
      "vehicles:\n"
      "  - name: hex1\n"
      "  - {name: hex2, height_m: 2}\n",
      "lab.yaml");
  EXPECT_EQ(read.vehicles[0].height_m, 1.5);
  EXPECT_EQ(read.vehicles[1].height_m, 2.0);
  EXPECT_EQ(read.vehicles[1].body_radius_m, 0.2);
}

TEST(VehicleDefaults, ApplyWhereverTheyStandInTheFile) {
  const Experiment read =
      parseExperiment("vehicles: [{name: hex1}]\nvehicle_defaults: {height_m: 1.5}\n", "lab.yaml");
  EXPECT_EQ(read.vehicles[0].height_m, 1.5);
}

TEST(Mission, ReadsEveryVerb) {
  const Experiment read = withTwo(
      "mission:\n"
      "  - take_off\n"
      "  - spell: CADRL\n"
      "  - spell: {text: CADRL, seconds: 2}\n"
      "  - formation: {name: swap, points: [[1, 2], [3, 4, 2]], seconds: 1}\n"
      "  - go_to: {vehicle: hex2, point: [1, 2, 3]}\n"
      "  - wait: 3\n"
      "  - hold\n"
      "  - land\n"
      "  - wait_until: go_on\n"
      "  - wait_until: 90\n");
  ASSERT_EQ(read.mission.size(), 10u);
  EXPECT_EQ(read.mission[0].verb, "take_off");
  EXPECT_EQ(read.mission[1].verb, "spell");
  EXPECT_EQ(read.mission[1].text, "CADRL");
  EXPECT_LT(read.mission[1].seconds, 0.0);
  EXPECT_EQ(read.mission[2].seconds, 2.0);
  EXPECT_EQ(read.mission[3].text, "swap");
  EXPECT_EQ(read.mission[3].seconds, 1.0);
  EXPECT_EQ(read.mission[3].points_m[1], Eigen::Vector3d(3.0, 4.0, 2.0));
  EXPECT_EQ(read.mission[4].vehicle, "hex2");
  EXPECT_EQ(read.mission[4].points_m, std::vector<Eigen::Vector3d>{Eigen::Vector3d(1, 2, 3)});
  EXPECT_EQ(read.mission[5].seconds, 3.0);
  EXPECT_EQ(read.mission[7].verb, "land");
  EXPECT_EQ(read.mission[8].text, "go_on");
  EXPECT_EQ(read.mission[9].text, "");
  EXPECT_EQ(read.mission[9].seconds, 90.0);
}

TEST(Mission, RepeatsSteps) {
  const Experiment read = withTwo(
      "mission:\n"
      "  - take_off\n"
      "  - repeat: {times: 2, steps: [{wait: 1}, {repeat: {times: 3, steps: [hold]}}]}\n");
  std::string verbs;
  for (const MissionStep& step : read.mission) {
    verbs += step.verb + " ";
  }
  EXPECT_EQ(verbs, "take_off wait hold hold hold wait hold hold hold ");
}

TEST(Mission, RepeatsOnlyWhatItUnderstands) {
  const auto problem = [](const std::string& repeat) -> std::string {
    try {
      withTwo("mission:\n  - repeat: " + repeat + "\n");
    } catch (const core::StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(problem("{times: 2}").find("expected times and steps"), std::string::npos);
  EXPECT_NE(problem("{times: 0, steps: [hold]}").find("mission[0].repeat.times"),
            std::string::npos);
  EXPECT_NE(problem("{times: 2, steps: [dance]}").find("mission[0].repeat.steps[0]"),
            std::string::npos);
  EXPECT_NE(problem("{times: 600, steps: [hold, hold]}").find("at most 1000 steps"),
            std::string::npos);
}

TEST(Obstacles, AreTurnedCounterClockwise) {
  const Experiment read = parseExperiment(
      "vehicles: [{name: hex1}]\n"
      "obstacles:\n"
      "  - {name: left, points_m: [[3, 3], [4, 3], [3, 4]]}\n"
      "  - {name: right, points_m: [[6, 3], [6, 4], [7, 3]]}\n",
      "lab.yaml");
  EXPECT_EQ(read.obstacles[0].points_m,
            (std::vector<Eigen::Vector2d>{{3.0, 3.0}, {4.0, 3.0}, {3.0, 4.0}}));
  EXPECT_EQ(read.obstacles[1].points_m,
            (std::vector<Eigen::Vector2d>{{7.0, 3.0}, {6.0, 4.0}, {6.0, 3.0}}));
}

TEST(Points, WithoutAHeightAreAtTheVehicles) {
  const Experiment read = parseExperiment(
      "vehicle_defaults: {height_m: 1.5}\n"
      "vehicles: [{name: hex1}, {name: hex2}]\n"
      "glyphs: [{name: I, points_m: [[0, 1], [0, 2, 3]]}]\n"
      "mission: [{formation: {name: line, points: [[1, 2]]}}]\n",
      "lab.yaml");
  EXPECT_EQ(read.glyphs[0].points_m[0], Eigen::Vector3d(0.0, 1.0, 1.5));
  EXPECT_EQ(read.glyphs[0].points_m[1], Eigen::Vector3d(0.0, 2.0, 3.0));
  EXPECT_EQ(read.mission[0].points_m[0], Eigen::Vector3d(1.0, 2.0, 1.5));
}

TEST(Points, OfGoToAreAtTheVehiclesOwnHeight) {
  const Experiment read = parseExperiment(
      "vehicles: [{name: hex1}, {name: hex2, height_m: 2}]\n"
      "mission: [{go_to: {vehicle: hex2, point: [1, 2]}}]\n",
      "lab.yaml");
  EXPECT_EQ(read.mission[0].points_m[0].z(), 2.0);
}

TEST(Override, ReplacesAValue) {
  const Experiment read = withTwo("sim: {pacing: lockstep}\n",
                                  {"vehicles.0.name=ugv", "sim.pacing=real_time", "seed=7"});
  EXPECT_EQ(read.vehicles[0].name, "ugv");
  EXPECT_EQ(read.vehicles[1].name, "hex2");
  EXPECT_EQ(read.sim.pacing, "real_time");
  EXPECT_EQ(read.seed, 7u);
}

TEST(Override, AddsKeysThatTheFileDoesNotHave) {
  const Experiment read =
      withTwo("", {"sim.mocap.dropout.duration_s=0.25", "vehicles[1].start.heading_rad=1"});
  EXPECT_EQ(read.sim.mocap.dropout.duration_s, 0.25);
  EXPECT_EQ(read.vehicles[1].start->heading_rad, 1.0);
}

TEST(ConfigReading, AnEmptyLidarHasTheDefaults) {
  const Experiment read = parseExperiment(
      "vehicles:\n  - {name: hex1, lidar: {}}\n  - {name: hex2, lidar: {beams: 16}}\n"
      "  - name: hex3\n",
      "lab.yaml");
  ASSERT_TRUE(read.vehicles[0].lidar);
  EXPECT_EQ(read.vehicles[0].lidar->beams, 512);
  EXPECT_EQ(read.vehicles[1].lidar->beams, 16);
  EXPECT_FALSE(read.vehicles[2].lidar);
}

TEST(Override, TakesYamlAndTheLastOneWins) {
  const Experiment read =
      withTwo("", {"mission=[take_off]", "mission=[take_off, {spell: AB}, land]",
                   "mission.1.spell=C", "lcm_url="});
  ASSERT_EQ(read.mission.size(), 3u);
  EXPECT_EQ(read.mission[1].text, "C");
  EXPECT_EQ(read.lcm_url, "");
}

TEST(Override, OfAnAliasedMapLeavesTheOtherUsersAlone) {
  const Experiment read = parseExperiment(
      "vehicles:\n"
      "  - {name: hex1, start: &corner {position_m: [1, 1]}}\n"
      "  - {name: hex2, start: *corner}\n",
      "lab.yaml", {"vehicles.1.start.position_m=[3, 3]"});
  EXPECT_EQ(read.vehicles[0].start->position_m, Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(read.vehicles[1].start->position_m, Eigen::Vector2d(3.0, 3.0));
}

TEST(Weights, InAFileAreMeantFromItsFolder) {
  EXPECT_EQ(parseExperiment("vehicles: [{name: a}]\nplanner: {policy: 'net:w/x.st'}",
                            "/lab/experiments/swap.yaml")
                .planner.policy,
            "net:/lab/experiments/w/x.st");
  EXPECT_EQ(parseExperiment("vehicles: [{name: a}]\nplanner: {policy: 'net:/w/x.st'}",
                            "/lab/experiments/swap.yaml")
                .planner.policy,
            "net:/w/x.st");
}

TEST(Weights, InAnOverrideAreMeantFromTheCurrentFolder) {
  EXPECT_EQ(parseExperiment("vehicles: [{name: a}]", "/lab/swap.yaml", {"planner.policy=net:x.st"})
                .planner.policy,
            "net:" + (std::filesystem::current_path() / "x.st").string());
}

TEST(ReadExperiment, ReadsAFile) {
  const test::ScratchFolder folder;
  const std::string path = folder / "lab.yaml";
  std::ofstream(path) << kTwoVehicles;
  const Experiment read = readExperiment(path, {"vehicles.0.name=ugv"});
  EXPECT_EQ(read.vehicles[0].name, "ugv");
  EXPECT_EQ(read.file, path);
  EXPECT_EQ(read.name, "lab");
}

class ShippedExperiment : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(ShippedExperiment, IsReadAndNamedAfterItsFile) {
  const Experiment read = readExperiment(GetParam());
  EXPECT_EQ(read.name, GetParam().stem());
  EXPECT_EQ(read.mission.front().verb, "take_off");
  EXPECT_EQ(read.mission.back().verb, "land");
}

std::vector<std::filesystem::path> shippedExperiments() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(ROUNDABOUT_SOURCE_DIR "/experiments")) {
    if (entry.is_regular_file()) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

INSTANTIATE_TEST_SUITE_P(Files, ShippedExperiment, testing::ValuesIn(shippedExperiments()),
                         [](const auto& instance) { return instance.param.stem().string(); });

TEST(ShippedExperiments, HaveThePapersNumbers) {
  const Experiment spell = readExperiment(ROUNDABOUT_SOURCE_DIR "/experiments/spell_cadrl.yaml");
  ASSERT_EQ(spell.vehicles.size(), 6u);
  EXPECT_EQ(spell.vehicles[5].preferred_speed_mps, 1.0);
  EXPECT_EQ(spell.glyphs.size(), 5u);
  for (const char* name : {"parallel_swap", "orthogonal_swap"}) {
    const Experiment swap =
        readExperiment(std::string(ROUNDABOUT_SOURCE_DIR "/experiments/") + name + ".yaml");
    ASSERT_EQ(swap.vehicles.size(), 4u);
    EXPECT_EQ(swap.vehicles[0].preferred_speed_mps, 0.5);
    EXPECT_EQ(swap.vehicles[0].assumed_radius_m, 0.5);
    EXPECT_EQ(swap.vehicles[0].body_radius_m, 0.35);
    EXPECT_EQ(swap.vehicles[0].height_m, 1.0);
    EXPECT_EQ(swap.planner.rate_hz, 10.0);
    EXPECT_EQ(swap.sim.mocap.rate_hz, 200.0);
    for (std::size_t i = 0; i < 4; ++i) {
      // Pairs (0, 1) and (2, 3) exchange places.
      EXPECT_EQ(swap.mission[1].points_m[i].head<2>(), swap.vehicles[i ^ 1].start->position_m);
    }
  }
}

}  // namespace
}  // namespace roundabout::config
