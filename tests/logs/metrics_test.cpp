#include "logs/metrics/metrics.h"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "common/bus/messages.h"
#include "common/config/experiment_file.h"
#include "logs/files.h"
#include "logs/metrics/metrics_json.h"
#include "logs/metrics/metrics_text.h"
#include "tests/logs/log_writer.h"
#include "tests/logs/synthetic_flight.h"
#include "tests/support/scratch_folder.h"

namespace roundabout::logs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kFrameS = 0.005;

void expectThreeLetters(const Metrics& metrics) {
  ASSERT_EQ(metrics.formations.size(), 3u);
  EXPECT_EQ(metrics.formations[0].name, "H");
  EXPECT_EQ(metrics.formations[1].name, "L");
  EXPECT_EQ(metrics.formations[2].name, "L");
  for (const FormationMetrics& formation : metrics.formations) {
    EXPECT_EQ(formation.legs.size(), 2u);
    EXPECT_NEAR(formation.time_to_form_s, 1.0, 1e-9);
  }
  EXPECT_EQ(metrics.formationsFormed(), 3);
  EXPECT_TRUE(metrics.success);
}

/// Bodies of 0.35 m, assumed radii of 0.5 m, preferred speed 1 m/s.
class MetricsTest : public testing::Test {
 protected:
  Metrics measure() {
    const std::string log = folder_.file("flight.lcm");
    synthetic_.write(log);
    config::Experiment experiment = synthetic_.experiment();
    experiment.obstacles = obstacles_;
    writeFile(folder_.file("experiment.yaml"), config::toYaml(experiment));
    flight_ = readFlight(log);
    return computeMetrics(flight_);
  }

  void loseFrames(double from_s, double to_s) {
    for (int frame = static_cast<int>(std::lround(from_s / kFrameS));
         frame < static_cast<int>(std::lround(to_s / kFrameS)); ++frame) {
      synthetic_.lost_frames.insert(frame);
    }
  }

  void hide(SyntheticVehicle& vehicle, double from_s, double to_s) {
    vehicle.untracked_from_s = from_s;
    vehicle.untracked_to_s = to_s;
  }

  /// Two that pass each other on parallel lines; closest at 5 s.
  void passAt(double distance_m) {
    synthetic_.vehicles = {{"hex1", straight({-5, 0, 1}, {5, 0, 1}, 1.0)},
                           {"hex2", straight({5, distance_m, 1}, {-5, distance_m, 1}, 1.0)}};
    synthetic_.formations = {{"swap", 0.0, 9.8, 10.0, {{5, 0, 1}, {-5, distance_m, 1}}}};
    synthetic_.duration_s = 11.0;
  }

  test::ScratchFolder folder_;
  std::vector<config::Obstacle> obstacles_;
  SyntheticFlight synthetic_;
  Flight flight_;
};

TEST_F(MetricsTest, FindsTheClosestApproachOfBodies) {
  passAt(1.2);
  const Metrics metrics = measure();
  EXPECT_NEAR(metrics.separation.body_gap.gap_m, 0.5, 1e-4);
  EXPECT_NEAR(metrics.separation.body_gap.at_s, 5.0, kFrameS);
  EXPECT_EQ(metrics.separation.body_gap.vehicle_a, "hex1");
  EXPECT_EQ(metrics.separation.body_gap.vehicle_b, "hex2");
  EXPECT_NEAR(metrics.separation.assumed_gap.gap_m, 0.2, 1e-4);
  EXPECT_THAT(metrics.separation.touches, IsEmpty());
  EXPECT_THAT(metrics.separation.approaches, IsEmpty());
  EXPECT_TRUE(metrics.success);
}

TEST_F(MetricsTest, TimesACloserApproachThanTheAssumedRadii) {
  passAt(0.8);
  const Metrics metrics = measure();
  EXPECT_THAT(metrics.separation.touches, IsEmpty());
  ASSERT_EQ(metrics.separation.approaches.size(), 1u);
  // Centres are nearer than 1 m while 2 m/s x |t - 5 s| < sqrt(1 - 0.8^2) m = 0.6 m.
  EXPECT_NEAR(metrics.separation.approaches[0].begin_at_s, 4.7, 2 * kFrameS);
  EXPECT_NEAR(metrics.separation.approaches[0].end_at_s, 5.3, 2 * kFrameS);
  EXPECT_NEAR(metrics.separation.approaching_time_s, 0.6, 2 * kFrameS);
  EXPECT_NEAR(metrics.separation.approaches[0].closest_gap_m, -0.2, 1e-3);
  EXPECT_EQ(metrics.formations[0].approaches, 1);
  EXPECT_TRUE(metrics.success);
}

TEST_F(MetricsTest, SaysHowNearAnObstacleABodyCame) {
  passAt(1.2);
  obstacles_ = {{"box", {{1.0, -2.0}, {2.0, -2.0}, {2.0, -0.5}, {1.0, -0.5}}}};
  const Metrics metrics = measure();
  EXPECT_NEAR(metrics.obstacles.closest.gap_m, 0.15, 1e-4);
  EXPECT_EQ(metrics.obstacles.closest.vehicle_a, "hex1");
  EXPECT_EQ(metrics.obstacles.closest.vehicle_b, "box");
  EXPECT_GE(metrics.obstacles.closest.at_s, 6.0 - kFrameS);
  EXPECT_LE(metrics.obstacles.closest.at_s, 7.0 + kFrameS);
  EXPECT_TRUE(metrics.success);
}

TEST_F(MetricsTest, ATouchedObstacleFailsTheFlight) {
  passAt(1.2);
  obstacles_ = {{"box", {{1.0, -2.0}, {2.0, -2.0}, {2.0, -0.3}, {1.0, -0.3}}}};
  const Metrics metrics = measure();
  EXPECT_FALSE(metrics.success);
  ASSERT_EQ(metrics.failures.size(), 1u);
  EXPECT_THAT(metrics.failures[0], HasSubstr("the body of hex1 touched obstacle box at 6.0 s "
                                             "(overlap 0.05 m)"));
  EXPECT_THAT(headline(metrics), HasSubstr("1 collision"));
}

TEST_F(MetricsTest, AnObstacleIsTouchedOnTheLineAcrossAShortTimeWithoutTrackingOrFrames) {
  // hex1 passes through a box of 0.2 m from 4.55 to 5.45 s.
  passAt(3.0);
  obstacles_ = {{"box", {{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}}};
  for (const bool frames_lost : {false, true}) {
    if (frames_lost) {
      hide(synthetic_.vehicles[0], 1e9, 1e9);
      loseFrames(4.54, 5.46);
    } else {
      hide(synthetic_.vehicles[0], 4.54, 5.46);
    }
    const Metrics metrics = measure();
    ASSERT_EQ(metrics.obstacles.touches.size(), 1u) << frames_lost;
    EXPECT_NEAR(metrics.obstacles.touches[0].gap_m, -0.1 - 0.35, 0.01);
    EXPECT_NEAR(metrics.obstacles.touches[0].at_s, 5.0, 2 * kFrameS);
    EXPECT_THAT(metrics.obstacles.unseen, IsEmpty());
    EXPECT_FALSE(metrics.success);
  }
}

TEST_F(MetricsTest, CannotTellWhetherAVehicleThatWasUnseenForLongTouchedAnObstacle) {
  passAt(9.0);
  obstacles_ = {{"box", {{-0.1, -0.9}, {0.1, -0.9}, {0.1, -0.7}, {-0.1, -0.7}}},
                {"far", {{-0.1, -3.9}, {0.1, -3.9}, {0.1, -3.7}, {-0.1, -3.7}}}};
  EXPECT_TRUE(measure().success);
  hide(synthetic_.vehicles[0], 4.0, 6.0);
  const Metrics metrics = measure();
  EXPECT_THAT(metrics.obstacles.touches, IsEmpty());
  EXPECT_THAT(metrics.failures, ElementsAre("cannot tell whether bodies touched: hex1 unseen "
                                            "4.0-6.0 s near box"));
  EXPECT_THAT(headline(metrics), HasSubstr("nobody saw whether bodies touched"));
  const auto json = nlohmann::json::parse(toJson(metrics));
  EXPECT_EQ(json["obstacles"]["unseen"][0]["near"][0], "box");
}

TEST_F(MetricsTest, OneThatSlidesAlongTheFloorTouchesAnObstacleOneThatRestsWasPutThere) {
  obstacles_ = {{"box", {{1.0, -1.0}, {2.0, -1.0}, {2.0, 1.0}, {1.0, 1.0}}}};
  synthetic_.vehicles = {{"hex1", straight({0, 0, 0.1}, {0.8, 0, 0.1}, 0.5)},
                         {"hex2", standing({2.2, 0, 0.1})}};
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.obstacles.touches.size(), 1u);
  EXPECT_EQ(metrics.obstacles.touches[0].vehicle_a, "hex1");
}

TEST_F(MetricsTest, CountsACollisionAndCallsTheFlightFailed) {
  passAt(0.42);
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.separation.touches.size(), 1u);
  // Centres are nearer than 0.7 m while 2 m/s x |t - 5 s| < sqrt(0.7^2 - 0.42^2) m = 0.56 m.
  EXPECT_NEAR(metrics.separation.touching_time_s, 0.56, 2 * kFrameS);
  EXPECT_EQ(metrics.formations[0].touches, 1);
  EXPECT_FALSE(metrics.success);
  EXPECT_THAT(metrics.failures, ElementsAre(HasSubstr("hex1 and hex2 touched")));
}

TEST_F(MetricsTest, CountsNoiseAroundContactAsOneEncounter) {
  synthetic_.vehicles = {{"hex1", standing({0, 0, 1})},
                         {"hex2", [](double at_s) -> Eigen::Vector3d {
                            return {0.7 + 0.001 * std::sin(200.0 * at_s), 0, 1};
                          }}};
  const Metrics metrics = measure();
  EXPECT_EQ(metrics.separation.touches.size(), 1u);
  EXPECT_NEAR(metrics.separation.touching_time_s, synthetic_.duration_s / 2, 0.2);
}

TEST_F(MetricsTest, VehiclesThatWerePutSideBySideOnTheFloorDoNotTouch) {
  synthetic_.vehicles = {{"hex1", standing({0, 0, 0.1})}, {"hex2", standing({0.1, 0, 0.0})}};
  const Metrics metrics = measure();
  EXPECT_THAT(metrics.separation.touches, IsEmpty());
  EXPECT_TRUE(std::isinf(metrics.separation.body_gap.gap_m));
}

TEST_F(MetricsTest, FlyingAboveOneThatStandsOnTheFloorIsACollision) {
  passAt(0.0);
  synthetic_.vehicles[1].position_world_m = standing({0.0, 0.3, 0.05});
  EXPECT_EQ(measure().separation.touches.size(), 1u);
}

TEST_F(MetricsTest, BodiesThatMeetJustAboveTheFloorTouch) {
  // Both come down at 0.3 m/s, half a metre apart, and have landed at 0.12 m after 5 s.
  synthetic_.vehicles = {{"hex1", straight({0, 0, 1.62}, {0, 0, 0.12}, 0.3)},
                         {"hex2", straight({3, 0, 0.14}, {0.5, 0, 0.12}, 0.5)}};
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.separation.touches.size(), 1u);
  EXPECT_LT(metrics.separation.touches[0].begin_at_s, 5.0);
  EXPECT_NEAR(metrics.separation.touches[0].end_at_s, 5.0, 0.05) << "then both rest";
}

TEST_F(MetricsTest, JudgesAShortTimeWithoutTrackingByTheLineAcrossIt) {
  passAt(0.4);
  synthetic_.vehicles[0].untracked_from_s = 4.6;
  synthetic_.vehicles[0].untracked_to_s = 5.4;
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.separation.touches.size(), 1u);
  EXPECT_NEAR(metrics.separation.body_gap.gap_m, 0.4 - 0.7, 1e-3);
  EXPECT_NEAR(metrics.separation.body_gap.at_s, 5.0, kFrameS);
  EXPECT_THAT(metrics.separation.unseen, IsEmpty());
  EXPECT_NEAR(metrics.vehicles[0].untracked_time_s, 0.8, 1e-6);
  EXPECT_NEAR(metrics.vehicles[0].path_length_m, 10.0, 0.02) << "joined straight across the gap";
}

TEST_F(MetricsTest, CannotTellWhatAVehicleTouchedThatWasUnseenForLong) {
  passAt(0.4);
  synthetic_.vehicles[0].untracked_from_s = 4.0;
  synthetic_.vehicles[0].untracked_to_s = 6.0;
  const Metrics metrics = measure();
  EXPECT_THAT(metrics.separation.touches, IsEmpty());
  EXPECT_FALSE(metrics.success);
  EXPECT_THAT(metrics.failures, ElementsAre("cannot tell whether bodies touched: hex1 unseen "
                                            "4.0-6.0 s near hex2"));
  EXPECT_THAT(headline(metrics), HasSubstr("nobody saw whether bodies touched"));
  const auto json = nlohmann::json::parse(toJson(metrics));
  EXPECT_EQ(json["separation"]["unseen"][0]["near"][0], "hex2");
}

TEST_F(MetricsTest, AVehicleUnseenForLongFarFromOthersHasTouchedNobody) {
  // Unseen for 2 s at no more than 2 m/s: it cannot have come 9 m.
  passAt(9.0);
  synthetic_.vehicles[0].untracked_from_s = 4.0;
  synthetic_.vehicles[0].untracked_to_s = 6.0;
  const Metrics metrics = measure();
  EXPECT_THAT(metrics.separation.unseen, IsEmpty());
  EXPECT_TRUE(metrics.success);
}

TEST_F(MetricsTest, CannotTellWhatTwoTouchedThatWereUnseenAtOnceAndSaysItOnce) {
  passAt(0.4);
  for (SyntheticVehicle& vehicle : synthetic_.vehicles) {
    vehicle.untracked_from_s = 4.0;
    vehicle.untracked_to_s = 6.0;
  }
  EXPECT_THAT(measure().failures, ElementsAre(HasSubstr("hex1 unseen 4.0-6.0 s near hex2")));
}

TEST_F(MetricsTest, CannotTellWhatAVehicleTouchedThatWasNotSeenAgain) {
  passAt(0.8);
  synthetic_.vehicles[0].untracked_from_s = 4.5;
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.separation.unseen.size(), 1u);
  EXPECT_NEAR(metrics.separation.unseen[0].end_at_s, 11.0, kFrameS);
}

TEST_F(MetricsTest, BodiesThatPassThroughEachOtherWhileFramesAreLostTouch) {
  passAt(0.0);
  loseFrames(4.55, 5.45);
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.separation.touches.size(), 1u);
  EXPECT_NEAR(metrics.separation.touches[0].closest_gap_m, -0.7, 1e-3);
  // Centres are nearer than 0.7 m while 2 m/s x |t - 5 s| < 0.7 m.
  EXPECT_NEAR(metrics.separation.touches[0].begin_at_s, 4.65, 1e-3);
  EXPECT_NEAR(metrics.separation.touches[0].end_at_s, 5.35, 1e-3);
  EXPECT_NEAR(metrics.separation.touching_time_s, 0.7, 1e-3);
  EXPECT_NEAR(metrics.separation.body_gap.at_s, 5.0, 1e-3);
  EXPECT_EQ(metrics.formations[0].touches, 1);
  EXPECT_NEAR(metrics.formations[0].body_gap.gap_m, -0.7, 1e-3);
  EXPECT_NEAR(metrics.formations[0].body_gap.at_s, 5.0, 1e-3);
  EXPECT_FALSE(metrics.success);
}

TEST_F(MetricsTest, CannotTellWhatHappenedWhenLostFramesFollowUponALostTrack) {
  // Of the 1.8 s in which hex1 was not seen the log holds only frames at their ends.
  passAt(0.4);
  hide(synthetic_.vehicles[0], 4.1, 5.9);
  loseFrames(4.11, 5.89);
  EXPECT_THAT(measure().failures, testing::Contains(HasSubstr("hex1 unseen 4.1-5.9 s near hex2")));
}

TEST_F(MetricsTest, CannotTellWhetherTwoThatPartedWhileTheLogLostFramesTouchedFirst) {
  // 0.8 m apart before, 4.2 m after 1.2 s: near enough only at the beginning.
  synthetic_.vehicles = {{"hex1", straight({0, 0, 1}, {-1.7, 0, 1}, 1.5, 4.0)},
                         {"hex2", straight({0.8, 0, 1}, {2.5, 0, 1}, 1.5, 4.0)}};
  loseFrames(4.0, 5.2);
  EXPECT_THAT(measure().failures, testing::Contains(HasSubstr("near hex2")));
}

TEST_F(MetricsTest, CannotTellWhatHappenedWhileTheLogLostFrames) {
  passAt(0.4);
  loseFrames(4.25, 5.75);
  EXPECT_THAT(measure().failures, testing::Contains(HasSubstr("hex1 unseen 4.2-5.8 s near hex2")));
}

TEST_F(MetricsTest, AVehicleThatStoodOnTheFloorBeforeAndAfterItWasHiddenHasStoodThere) {
  passAt(0.0);
  synthetic_.vehicles[1].position_world_m = standing({0.0, 1.0, 0.05});
  synthetic_.formations[0].goals_world_m[1] = {0.0, 1.0, 1.0};
  synthetic_.vehicles[1].untracked_from_s = 4.0;
  synthetic_.vehicles[1].untracked_to_s = 6.0;
  const Metrics metrics = measure();
  EXPECT_THAT(metrics.separation.unseen, IsEmpty());
  EXPECT_NEAR(metrics.separation.body_gap.gap_m, 1.0 - 0.7, 1e-3);
}

TEST_F(MetricsTest, MeasuresTheTimeBeyondTheStraightLine) {
  // 4 m at 0.8 m/s after waiting 1 s: 0.3 m before the goal after 1 + 3.7 / 0.8 s; least 3.7 s.
  synthetic_.vehicles = {{"hex1", straight({0, 0, 1}, {4, 0, 1}, 0.8, 2.0)},
                         {"hex2", standing({0, 5, 1})}};
  synthetic_.formations = {{"C", 1.0, 7.0, 9.0, {{4, 0, 1}, {0, 5, 1}}}};
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.formations.size(), 1u);
  const FormationMetrics& formation = metrics.formations[0];
  EXPECT_TRUE(formation.formed);
  EXPECT_NEAR(formation.time_to_form_s, 6.0, 1e-9);
  ASSERT_EQ(formation.legs.size(), 2u);
  const LegMetrics& leg = formation.legs[0];
  EXPECT_TRUE(leg.reached);
  EXPECT_NEAR(leg.straight_line_m, 4.0, 1e-9);
  EXPECT_NEAR(leg.time_to_goal_s, 1.0 + 3.7 / 0.8, kFrameS);
  EXPECT_NEAR(leg.extra_time_s, 1.0 + 3.7 / 0.8 - 3.7, kFrameS);
  EXPECT_NEAR(leg.path_length_m, 3.7, 0.02);
  EXPECT_NEAR(formation.legs[1].time_to_goal_s, 0.0, 1e-9);
  EXPECT_NEAR(formation.legs[1].extra_time_s, 0.0, 1e-9);
}

TEST_F(MetricsTest, FindsEveryLetterInOrderEvenTwiceTheSame) {
  synthetic_.vehicles = {{"hex1", standing({0, 0, 1})}, {"hex2", standing({0, 5, 1})}};
  const std::vector<Eigen::Vector3d> goals{{0, 0, 1}, {0, 5, 1}};
  synthetic_.formations = {
      {"H", 1.0, 2.0, 3.0, goals}, {"L", 3.0, 4.0, 5.0, goals}, {"L", 5.0, 6.0, 7.0, goals}};
  for (const bool by_messages : {false, true}) {
    synthetic_.by_messages = by_messages;
    expectThreeLetters(measure());
  }
}

TEST_F(MetricsTest, FailsIfALetterWasNotFormed) {
  passAt(2.0);
  synthetic_.formations[0].formed_at_s = 1e9;
  synthetic_.last_phase = FleetPhase::kFailed;
  const Metrics metrics = measure();
  EXPECT_FALSE(metrics.success);
  EXPECT_THAT(metrics.failures, ElementsAre("swap was not formed", HasSubstr("phase failed")));
  EXPECT_TRUE(std::isnan(metrics.formations[0].time_to_form_s));
}

TEST_F(MetricsTest, FailsIfTheLogEndsBeforeTheMission) {
  passAt(2.0);
  synthetic_.duration_s = 9.9;
  const Metrics metrics = measure();
  EXPECT_EQ(metrics.formationsFormed(), 1);
  EXPECT_THAT(metrics.failures, ElementsAre(HasSubstr("ended in phase hold")));
}

TEST_F(MetricsTest, FailsIfTheMissionWasLeftBeforeItsEnd) {
  passAt(2.0);
  synthetic_.last_phase = FleetPhase::kIdle;
  synthetic_.steps_left_out = 2;
  EXPECT_THAT(measure().failures, ElementsAre("the mission was left at step 1 of 3"));
}

TEST_F(MetricsTest, DoesNotCallALetterFormedThatSomebodyIsMissingFrom) {
  passAt(2.0);
  synthetic_.formations[0].goals_world_m[1] = {-8, 2, 1};
  const Metrics metrics = measure();
  EXPECT_FALSE(metrics.formations[0].formed);
  EXPECT_FALSE(metrics.formations[0].legs[1].reached);
  EXPECT_THAT(metrics.failures, ElementsAre("swap was not formed: hex2 did not reach the goal"));
}

TEST_F(MetricsTest, GoesOnWithAFormationWhenARestartedFleetGivesItsGoalsAgain) {
  passAt(2.0);
  SyntheticFormation& swap = synthetic_.formations[0];
  swap = {"swap", 0.0, 3.0, 4.0, swap.goals_world_m};
  SyntheticFormation again = {"swap", 5.0, 9.8, 10.0, swap.goals_world_m};
  again.restarted = true;
  synthetic_.formations.push_back(again);
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.formations.size(), 1u);
  EXPECT_NEAR(metrics.formations[0].begin_at_s, 0.0, 1e-9);
  EXPECT_NEAR(metrics.formations[0].end_at_s, 10.0, 1e-9);
}

TEST_F(MetricsTest, CountsMissingFrames) {
  passAt(2.0);
  synthetic_.lost_frames = {100, 101, 700};
  const Metrics metrics = measure();
  EXPECT_EQ(metrics.timing.missing_frames, 3);
  EXPECT_EQ(metrics.timing.frames, 2201 - 3);
  EXPECT_DOUBLE_EQ(metrics.timing.nominal_interval_s, kFrameS);
  EXPECT_DOUBLE_EQ(metrics.timing.data_duration_s, 11.0);
}

TEST_F(MetricsTest, MeasuresRateAndJitterByLogTimes) {
  passAt(2.0);
  synthetic_.wall_clock_per_data = 1.0;
  // Every tenth frame arrives 0.4 ms late: of its two intervals one is longer, one shorter.
  synthetic_.frame_jitter_us = [](int number) { return number % 10 == 5 ? 400 : 0; };
  const Metrics metrics = measure();
  EXPECT_TRUE(metrics.timing.real_time);
  EXPECT_NEAR(metrics.timing.rate_hz, 200.0, 1e-6);
  EXPECT_NEAR(metrics.timing.interval_error_s.p50, 0.0, 1e-9);
  EXPECT_NEAR(metrics.timing.interval_error_s.p99, 4e-4, 1e-9);
  EXPECT_NEAR(metrics.timing.interval_error_s.max, 4e-4, 1e-9);
  EXPECT_TRUE(metrics.timing.steady);
}

TEST_F(MetricsTest, CallsLateFramesAndLostFramesUnsteady) {
  passAt(2.0);
  synthetic_.wall_clock_per_data = 1.0;
  synthetic_.frame_jitter_us = [](int number) { return number % 10 == 5 ? 1100 : 0; };
  EXPECT_FALSE(measure().timing.steady);
  synthetic_.frame_jitter_us = nullptr;
  EXPECT_TRUE(measure().timing.steady);
  synthetic_.lost_frames = {103};
  EXPECT_FALSE(measure().timing.steady);
}

TEST_F(MetricsTest, MeasuresPlannersByTheirCommandsAndStatuses) {
  passAt(2.0);
  synthetic_.wall_clock_per_data = 1.0;
  synthetic_.command_delay_us = 3000;
  const Metrics metrics = measure();
  const VehicleMetrics& vehicle = metrics.vehicles[0];
  EXPECT_EQ(vehicle.policy, "orca");
  EXPECT_EQ(vehicle.commands, 111);
  EXPECT_NEAR(vehicle.command_rate_hz, 10.0, 1e-9);
  EXPECT_NEAR(vehicle.command_latency_s.p50, 0.003, 1e-9);
  EXPECT_NEAR(vehicle.compute_time_s.p50, 5e-6, 1e-12);
  ASSERT_EQ(vehicle.time_in_mode_s.size(), 1u);
  EXPECT_EQ(vehicle.time_in_mode_s[0].first, PlannerMode::kFlying);
  EXPECT_NEAR(vehicle.time_in_mode_s[0].second, 11.0, 1e-9);
  EXPECT_NEAR(vehicle.path_length_m, 10.0, 0.02);
  EXPECT_NEAR(vehicle.max_speed_mps, 1.0, 1e-6);
  EXPECT_THAT(metrics.faults.silences, IsEmpty());
}

TEST_F(MetricsTest, MeasuresAccelerationWithoutTheNoiseOfOneFrame) {
  synthetic_.vehicles = {{"hex1", [](double at_s) -> Eigen::Vector3d {
                            return {0.6 * at_s * at_s + 1e-5 * std::sin(1e4 * at_s), 0, 1};
                          }}};
  synthetic_.duration_s = 3.0;
  EXPECT_NEAR(measure().vehicles[0].max_acceleration_mps2, 1.2, 0.35);
}

TEST_F(MetricsTest, AddsNoPathForANoisyHover) {
  synthetic_.vehicles = {
      {"hex1", [](double at_s) -> Eigen::Vector3d {
         return {0.002 * std::sin(500.0 * at_s), 0.002 * std::cos(700.0 * at_s), 1};
       }}};
  EXPECT_EQ(measure().vehicles[0].path_length_m, 0.0);
}

TEST_F(MetricsTest, NamesThePlannerThatDied) {
  passAt(2.0);
  synthetic_.vehicles[1].planner_dies_at_s = 4.05;
  const Metrics metrics = measure();
  ASSERT_EQ(metrics.faults.silences.size(), 1u);
  EXPECT_EQ(metrics.faults.silences[0].who, "planner of hex2");
  EXPECT_NEAR(metrics.faults.silences[0].begin_at_s, 4.0, 1e-9);
  EXPECT_FALSE(metrics.faults.silences[0].returned);
  EXPECT_THAT(toText(flight_, metrics), HasSubstr("planner of hex2 silent from 4.0 s to the end"));
}

TEST_F(MetricsTest, ReportsStatesThatStoppedWhileOthersWereHeard) {
  passAt(2.0);
  synthetic_.duration_s = 6.0;
  const std::string log = folder_.file("flight.lcm");
  synthetic_.write(log);
  const core::Utime last = readFlight(log).log_end_utime;
  const std::string states = readFile(log);
  {
    LogWriter writer(log);
    roundabout_msgs::command_t hold{};
    hold.vehicle = "hex1";
    hold.mode = roundabout_msgs::command_t::HOLD;
    writer.write(last + 2'500'000, bus::commandChannel("hex1"), hold);
  }
  writeFile(log, states + readFile(log));
  const Metrics metrics = computeMetrics(readFlight(log));
  ASSERT_EQ(metrics.faults.silences.size(), 1u);
  EXPECT_EQ(metrics.faults.silences[0].who, "vehicle states");
  EXPECT_NEAR(metrics.faults.silences[0].begin_at_s, 6.0, 1e-9);
  EXPECT_FALSE(metrics.success);
}

TEST_F(MetricsTest, AreTheSameWhereverTheLogIsDamaged) {
  passAt(0.8);
  const Metrics whole = measure();
  std::string bytes = readFile(flight_.log_file);
  bytes.insert(bytes.size() / 2, "a block that some other program wrote");
  // The insertion lands within an event, which is lost; nothing else is.
  writeFile(flight_.log_file, bytes);
  const Flight damaged = readFlight(flight_.log_file);
  const Metrics metrics = computeMetrics(damaged);
  EXPECT_EQ(damaged.damage.places.size(), 1u);
  EXPECT_NEAR(metrics.separation.body_gap.gap_m, whole.separation.body_gap.gap_m, 1e-3);
  EXPECT_EQ(metrics.separation.approaches.size(), whole.separation.approaches.size());
  EXPECT_EQ(metrics.formationsFormed(), 1);
  EXPECT_LE(metrics.timing.missing_frames, 1);
}

TEST_F(MetricsTest, CountTheShieldsInterventionsByLayer) {
  passAt(2.0);
  measure();
  auto& statuses = flight_.vehicles[0].statuses;
  const std::size_t steps = statuses.size();
  for (Logged<PlannerStatus>& status : statuses) {
    status.value.predicted_gap_m = 0.5;
  }
  const auto act = [&](std::size_t status, core::ShieldLayer layer) {
    statuses[status].value.shield_layer = layer;
    for (std::size_t i = status; i < statuses.size(); ++i) {
      ++statuses[i].value.shield_interventions;
    }
  };
  act(3, core::ShieldLayer::kHard);
  act(4, core::ShieldLayer::kBreaker);
  act(5, core::ShieldLayer::kBreaker);
  statuses[5].value.predicted_gap_m = 0.125;
  statuses[7].value.shield_layer = core::ShieldLayer::kNotAsked;
  statuses.insert(statuses.begin() + 6, statuses[5]);  // a status that is said again

  const Metrics metrics = computeMetrics(flight_);
  const ShieldMetrics& shield = metrics.vehicles[0].shield;
  EXPECT_EQ(shield.steps, static_cast<int>(steps) - 1);
  EXPECT_EQ(shield.interventions, 3);
  EXPECT_DOUBLE_EQ(shield.changedShare(), 3.0 / shield.steps);
  EXPECT_THAT(shield.by_layer, ElementsAre(std::pair(core::ShieldLayer::kHard, 1),
                                           std::pair(core::ShieldLayer::kBreaker, 2)));
  EXPECT_DOUBLE_EQ(shield.smallest_predicted_gap_m, 0.125);
  EXPECT_THAT(toText(flight_, metrics), HasSubstr("1 hard, 2 breaker"));
  const auto json = nlohmann::json::parse(toJson(metrics));
  EXPECT_EQ(json["vehicles"][0]["shield"]["by_layer"]["breaker"], 2);
}

TEST_F(MetricsTest, AJsonFileHoldsThemWithUnitsInTheKeys) {
  passAt(0.8);
  const Metrics metrics = measure();
  writeMetricsJson(metrics, folder_.file("metrics.json"));
  const auto json = nlohmann::json::parse(readFile(folder_.file("metrics.json")));
  EXPECT_EQ(json["success"], true);
  EXPECT_EQ(json["formations_formed"], 1);
  EXPECT_NEAR(json["separation"]["closest_body_gap"]["gap_m"], 0.1, 1e-3);
  EXPECT_EQ(json["separation"]["closer_than_assumed"]["count"], 1);
  EXPECT_EQ(json["formations"][0]["vehicles"][1]["vehicle"], "hex2");
  EXPECT_NEAR(json["vehicles"][0]["time_in_mode_s"]["flying"], 11.0, 1e-6);
  EXPECT_EQ(json["timing"]["missing_frames"], 0);
  EXPECT_EQ(json["phases"].back()["phase"], "done");
}

/// A vehicle of 0.35 m drives 2 m a second past people of 0.25 m, seen once a second.
class PeopleMetricsTest : public MetricsTest {
 protected:
  Metrics withPeopleAt(double near_m, double far_m) {
    passAt(3.0);
    measure();
    for (int second = 0; second < 3; ++second) {
      flight_.people.push_back({flight_.utimeAt(second),
                                {{7, {1.0, near_m}, 0.25}, {8, {3.0, far_m}, 0.25}},
                                {{2.0 * second, 0.0}, {0.0, -50.0}}});
    }
    return computeMetrics(flight_);
  }
};

TEST_F(PeopleMetricsTest, SaysWhoCameNearestBetweenTwoMessages) {
  const Metrics metrics = withPeopleAt(0.9, -1.5);
  EXPECT_EQ(metrics.people.people, 2);
  EXPECT_NEAR(metrics.people.closest.gap_m, 0.9 - 0.35 - 0.25, 1e-9);
  EXPECT_NEAR(metrics.people.closest.at_s, 0.5, 1e-6);
  EXPECT_EQ(metrics.people.closest.vehicle_a, "hex1");
  EXPECT_EQ(metrics.people.closest.vehicle_b, "pedestrian 7");
  EXPECT_THAT(metrics.people.touches, IsEmpty());
  EXPECT_TRUE(metrics.success);
  EXPECT_THAT(toText(flight_, metrics),
              HasSubstr("closest person       0.300 m, hex1 and pedestrian 7 at 0.5 s of 2"));
  const auto json = nlohmann::json::parse(toJson(metrics));
  EXPECT_EQ(json["people"]["count"], 2);
  EXPECT_NEAR(json["people"]["closest_gap"]["gap_m"], 0.3, 1e-9);
}

TEST_F(PeopleMetricsTest, ATouchFailsTheFlightAndCountsOnce) {
  const Metrics metrics = withPeopleAt(0.5, -0.2);
  ASSERT_EQ(metrics.people.touches.size(), 2u);
  EXPECT_EQ(metrics.people.touches[0].vehicle_b, "pedestrian 7");
  EXPECT_NEAR(metrics.people.touches[0].gap_m, -0.1, 1e-9);
  EXPECT_EQ(metrics.people.touches[1].vehicle_b, "pedestrian 8");
  EXPECT_FALSE(metrics.success);
}

TEST_F(MetricsTest, AnUnknownNumberIsNullInJson) {
  synthetic_.vehicles = {{"hex1", standing({0, 0, 1})}};
  const auto json = nlohmann::json::parse(toJson(measure()));
  EXPECT_TRUE(json["separation"]["closest_body_gap"].is_null());
}

TEST_F(MetricsTest, ALogWithoutStatesFailsWithAReason) {
  const std::string log = folder_.file("quiet.lcm");
  {
    LogWriter writer(log);
    writer.write(1, "SAFETY_ORDER", bus::toMessage(core::SafetyOrder{}));
  }
  const Metrics metrics = computeMetrics(readFlight(log));
  EXPECT_FALSE(metrics.success);
  EXPECT_EQ(metrics.failures[0], "the log holds no VEHICLE_STATES");
}

}  // namespace
}  // namespace roundabout::logs
