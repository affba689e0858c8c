#include <limits>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mocap_bridge/estimation/state_estimator.h"
#include "tests/mocap_bridge/estimation/flown_path.h"
#include "tests/support/allocation_count.h"
#include "tests/support/startup_error.h"

namespace roundabout::mocap_bridge {
namespace {

using test::FlownPath;
using testing::HasSubstr;

constexpr core::Utime kEpoch = 1'700'000'000'000'000;

TEST(AxisMap, MotivesAxesKeepTheSenseOfTurning) {
  const AxisMap axes("y_up");
  EXPECT_TRUE(axes.toWorld(Eigen::Vector3d(1.0, 2.0, 3.0)).isApprox(Eigen::Vector3d(1, -3, 2)));
  const Eigen::Quaterniond about_y(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()));
  const Eigen::Quaterniond about_z(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(axes.toWorld(about_y).isApprox(about_z));
}

TEST(AxisMap, TurnsPositionsAndAttitudesAlike) {
  core::RandomStream random(1, "axes");
  for (const char* text : {"x,-z,y", "z,x,y", "-x,-y,z", "y,-x,z"}) {
    const AxisMap axes(text);
    const Eigen::Quaterniond turn = core::fromRotationVector(random.normal3(1.0));
    const Eigen::Vector3d point = random.normal3(1.0);
    EXPECT_TRUE(axes.toWorld(turn * point).isApprox(axes.toWorld(turn) * axes.toWorld(point)));
    EXPECT_TRUE(axes.inverse().toWorld(axes.toWorld(point)).isApprox(point));
  }
}

TEST(AxisMap, RefusesMirrorsAndNonsense) {
  for (const char* text : {"x,z,y", "x,y", "x,y,z,", "x,x,y", "up", "", "x;y;z"}) {
    EXPECT_THAT(test::startupErrorOf([&] { AxisMap{text}; }), HasSubstr("axes")) << text;
  }
  EXPECT_THAT(test::startupErrorOf([] { AxisMap{"x,z,y"}; }), HasSubstr("mirror image"));
}

config::Experiment experimentWith(int vehicles) {
  config::Experiment experiment;
  for (int i = 0; i < vehicles; ++i) {
    experiment.vehicles.emplace_back().name = "hex" + std::to_string(i + 1);
  }
  experiment.mocap.axes = "z_up";
  return experiment;
}

/// Flights with known truth before emulated cameras, and everything that is published of them.
class EstimatorTest : public testing::Test {
 protected:
  explicit EstimatorTest(int vehicles = 2)
      : experiment_(experimentWith(vehicles)), estimator_(experiment_, "z_up") {
    for (int i = 0; i < vehicles; ++i) {
      paths_.emplace_back(i);
    }
  }

  using Spoil = std::function<void(SourceFrame&)>;

  // One camera frame; `spoil` may do with it what it likes before the estimator sees it.
  void step(const Spoil& spoil = {}) {
    ++number_;
    SourceFrame frame;
    frame.number = number_;
    frame.exposure_utime = kEpoch + number_ * 5000;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      frame.bodies.push_back(cameras_.see(truth(i), estimator_.vehicles()[i].name));
    }
    if (spoil) {
      spoil(frame);
    }
    estimator_.update(frame);
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      const core::VehicleState& state = estimator_.states().vehicles[i];
      const bool shown = state.tracked || state.predicted;
      worst_m_ = shown ? std::max(worst_m_, (state.position_world_m - truth(i).position_m).norm())
                       : worst_m_;
      worst_rad_ =
          shown ? std::max(worst_rad_, state.orientation.angularDistance(truth(i).orientation))
                : worst_rad_;
    }
  }
  void run(double seconds, const Spoil& spoil = {}) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 200.0)); ++i) {
      step(spoil);
    }
  }
  FlownPath::Truth truth(std::size_t vehicle) const {
    return paths_[vehicle].at(static_cast<double>(number_) * 0.005);
  }
  const core::VehicleState& state(std::size_t vehicle) const {
    return estimator_.states().vehicles[vehicle];
  }
  std::int64_t count(std::size_t vehicle, Verdict verdict) const {
    return estimator_.vehicles()[vehicle].tracker.count(verdict);
  }
  // s until the vehicle is tracked, at most one.
  double untilTracked(std::size_t vehicle) {
    const std::int64_t began = number_;
    while (number_ - began < 200) {
      step();
      if (state(vehicle).tracked) {
        break;
      }
    }
    return static_cast<double>(number_ - began) * 0.005;
  }

  config::Experiment experiment_;
  StateEstimator estimator_;
  std::vector<FlownPath> paths_;
  test::Cameras cameras_;
  std::int64_t number_ = 0;
  double worst_m_ = 0.0;
  double worst_rad_ = 0.0;
};

TEST_F(EstimatorTest, VelocityIsWithinFiveCentimetresASecond) {
  run(1.0);
  double squares = 0.0;
  double rate_squares = 0.0;
  double top_speed = 0.0;
  double top_acceleration = 0.0;
  for (int i = 0; i < 4000; ++i) {
    step();
    squares += (state(0).velocity_world_mps - truth(0).velocity_mps).squaredNorm();
    rate_squares += (state(0).angular_velocity_body_radps - truth(0).rate_body_radps).squaredNorm();
    top_speed = std::max(top_speed, truth(0).velocity_mps.norm());
    top_acceleration = std::max(top_acceleration, truth(0).acceleration_mps2.norm());
  }
  EXPECT_GT(top_speed, 1.7) << "the flight is as lively as was asked for";
  EXPECT_GT(top_acceleration, 4.5);
  const double rms_mps = std::sqrt(squares / 4000.0);
  EXPECT_LT(rms_mps, 0.05);
  EXPECT_LT(std::sqrt(rate_squares / 4000.0), 0.25);
  EXPECT_LT(worst_m_, 0.002);
  RecordProperty("velocity_rms_mps", std::to_string(rms_mps));
}

TEST_F(EstimatorTest, AcquiredWithinATenthOfASecond) {
  EXPECT_LE(untilTracked(0), 0.1);
  EXPECT_EQ(state(0).last_seen, estimator_.states().exposure_utime);
}

TEST_F(EstimatorTest, ShortDropoutsAreCoastedAndSaid) {
  run(1.0);
  const core::Utime last_seen = estimator_.states().exposure_utime;
  run(0.05, [](SourceFrame& frame) { frame.bodies[0].tracked = false; });
  EXPECT_FALSE(state(0).tracked);
  EXPECT_TRUE(state(0).predicted);
  EXPECT_EQ(state(0).last_seen, last_seen);
  EXPECT_TRUE(state(1).tracked);
  step();
  EXPECT_TRUE(state(0).tracked) << "found again at once";
  EXPECT_LT(worst_m_, 0.02);
}

TEST_F(EstimatorTest, LongDropoutsLoseTheVehicleAndItIsFoundWithinATenthOfASecond) {
  run(1.0);
  run(0.5, [](SourceFrame& frame) { frame.bodies.erase(frame.bodies.begin()); });
  EXPECT_FALSE(state(0).tracked);
  EXPECT_FALSE(state(0).predicted);
  EXPECT_LE(untilTracked(0), 0.1);
  EXPECT_LT((state(0).velocity_world_mps - truth(0).velocity_mps).norm(), 0.2);
  EXPECT_LT(worst_m_, 0.12) << "at the end of coasting";
}

TEST_F(EstimatorTest, ExchangedBodiesAreNeverPublishedThoughTheyStayExchanged) {
  run(1.0);
  run(5.0, [](SourceFrame& frame) { std::swap(frame.bodies[0].name, frame.bodies[1].name); });
  EXPECT_FALSE(state(0).tracked);
  EXPECT_GT(count(0, Verdict::kSwap), 900);
  EXPECT_TRUE(estimator_.vehicles()[0].tracker.stuckWith(estimator_.states().exposure_utime));
  EXPECT_LE(untilTracked(0), 0.1);
  EXPECT_LT(worst_m_, 0.12);
}

void exchange(SourceFrame& frame) { std::swap(frame.bodies[0].name, frame.bodies[1].name); }

void hide(SourceFrame& frame) {
  for (BodyPose& body : frame.bodies) {
    body.tracked = false;
  }
}

void turnRound(SourceFrame& frame) {
  frame.bodies[0].orientation =
      frame.bodies[0].orientation * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ());
}

TEST_F(EstimatorTest, ExchangedBodiesAreNotBelievedAfterAGap) {
  run(1.0);
  for (const double gap_s : {0.06, 0.3, 1.0}) {
    run(2.5, exchange);
    run(gap_s, hide);
    run(0.5, exchange);
    EXPECT_FALSE(state(0).tracked) << gap_s;
    EXPECT_FALSE(state(1).tracked) << gap_s;
    EXPECT_LE(untilTracked(0), 0.1) << gap_s;
    run(0.2);
    EXPECT_TRUE(state(1).tracked) << gap_s;
    run(1.0);
  }
  EXPECT_LT(worst_m_, 0.12);
}

TEST_F(EstimatorTest, AFlipIsNotBelievedAfterAGapOrAnOutlier) {
  const auto away = [](SourceFrame& frame) { frame.bodies[0].position_m.z() += 0.5; };
  for (const auto& [seconds, interruption] : {std::pair(0.06, Spoil(hide)), {0.02, away}}) {
    run(1.0);
    run(1.0, turnRound);
    run(seconds, interruption);
    run(1.0, turnRound);
    run(0.5, hide);
    run(1.0, turnRound);
    EXPECT_FALSE(state(0).tracked);
    step();  // the right way round for a moment only
    run(0.2, turnRound);
    EXPECT_FALSE(state(0).tracked);
    run(0.06, hide);
    EXPECT_LE(untilTracked(0), 0.1);
  }
  EXPECT_LT(worst_rad_, 0.35);
}

TEST_F(EstimatorTest, AFlipIsForgottenWithTheTrackThatItContradicts) {
  run(1.0);
  run(9.0, turnRound);
  run(0.06, hide);
  run(0.3, turnRound);
  EXPECT_FALSE(state(0).tracked);
  run(1.0, hide);
  run(0.2, turnRound);
  EXPECT_TRUE(state(0).tracked);
}

TEST_F(EstimatorTest, ASwapOfTwoFramesIsCoasted) {
  run(1.0);
  run(0.01, [](SourceFrame& frame) { std::swap(frame.bodies[0].name, frame.bodies[1].name); });
  EXPECT_TRUE(state(0).predicted);
  step();
  EXPECT_TRUE(state(0).tracked);
  EXPECT_LT(worst_m_, 0.005);
}

TEST_F(EstimatorTest, FlipsOfAnyLengthAreNotPublished) {
  const auto flip = [](SourceFrame& frame) {
    frame.bodies[0].orientation =
        frame.bodies[0].orientation * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ());
  };
  for (const double seconds : {0.005, 0.05, 2.0}) {
    run(1.0);
    run(seconds, flip);
    EXPECT_FALSE(state(0).tracked);
    EXPECT_LE(untilTracked(0), 0.1) << seconds;
  }
  EXPECT_GT(count(0, Verdict::kFlip), 300);
  EXPECT_LT(worst_rad_, 0.35);
}

TEST_F(EstimatorTest, AJumpIsBelievedAfterASecondOnly) {
  run(1.0);
  const auto jump = [](SourceFrame& frame) { frame.bodies[0].position_m.y() += 3.0; };
  run(0.95, jump);
  EXPECT_FALSE(state(0).tracked);
  EXPECT_LT(worst_m_, 0.12);
  run(0.2, jump);
  EXPECT_TRUE(state(0).tracked);
}

TEST_F(EstimatorTest, WhatIsNoMeasurementIsRefusedAndCounted) {
  run(1.0);
  step([](SourceFrame& f) {
    f.bodies[0].position_m.x() = std::numeric_limits<double>::quiet_NaN();
  });
  EXPECT_EQ(count(0, Verdict::kNotFinite), 1);
  step([](SourceFrame& f) { f.bodies[0].orientation.coeffs() *= 1.2; });
  EXPECT_EQ(count(0, Verdict::kNotRotation), 1);
  step([](SourceFrame& f) { f.bodies[0].residual_m = 0.02; });
  EXPECT_EQ(count(0, Verdict::kBadFit), 1);
  EXPECT_TRUE(state(0).predicted);
  step();
  EXPECT_TRUE(state(0).tracked);
  EXPECT_LT(worst_m_, 0.005);
}

TEST_F(EstimatorTest, AFrozenPoseIsNoMeasurement) {
  run(1.0);
  BodyPose frozen = cameras_.see(truth(0), "hex1");
  run(1.0, [&](SourceFrame& frame) { frame.bodies[0] = frozen; });
  EXPECT_GT(count(0, Verdict::kFrozen), 190);
  EXPECT_FALSE(state(0).tracked);
}

TEST_F(EstimatorTest, TheSignOfAQuaternionMeansNothing) {
  run(1.0);
  for (int i = 0; i < 200; ++i) {
    step([&](SourceFrame& f) { f.bodies[0].orientation.coeffs() *= i % 2 == 0 ? -1.0 : 1.0; });
    EXPECT_TRUE(state(0).tracked);
  }
}

TEST_F(EstimatorTest, PlayedBackAndOldFramesAreNotUsed) {
  run(0.5);
  const core::Utime utime = estimator_.states().exposure_utime;
  step([](SourceFrame& frame) { frame.recorded = true; });
  EXPECT_EQ(estimator_.states().exposure_utime, utime);
  EXPECT_EQ(estimator_.counters().recorded, 1);
  step([&](SourceFrame& frame) { frame.exposure_utime = utime - 10'000; });
  EXPECT_EQ(estimator_.counters().old, 1);
}

TEST_F(EstimatorTest, ResampledStatesLieBetweenTheFrames) {
  run(1.0);
  const core::Utime later = estimator_.states().exposure_utime + 2'500;
  const core::StatesFrame& states = estimator_.statesAt(later);
  EXPECT_EQ(states.utime, later);
  EXPECT_EQ(states.exposure_utime, later - 2'500);
  const auto there = paths_[0].at(static_cast<double>(number_) * 0.005 + 0.0025);
  EXPECT_LT((states.vehicles[0].position_world_m - there.position_m).norm(), 0.001);
}

TEST_F(EstimatorTest, UpdatesAllocateNothing) {
  run(0.5);
  SourceFrame frame;
  frame.bodies.push_back(cameras_.see(truth(0), "hex1"));
  frame.exposure_utime = kEpoch + (number_ + 1) * 5000;
  const std::size_t before = test::allocationCount();
  estimator_.update(frame);
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(StateEstimator, SlowCamerasAreAcquiredAndKept) {
  for (const int rate_hz : {5, 10, 15, 19, 30}) {
    StateEstimator estimator(experimentWith(1), "z_up");
    test::Cameras cameras;
    const FlownPath path;
    int tracked = 0;
    for (int i = 0; i < 10 * rate_hz; ++i) {
      SourceFrame frame;
      frame.exposure_utime = kEpoch + i * core::kMicrosPerSecond / rate_hz;
      frame.bodies = {cameras.see(path.at(static_cast<double>(i) / rate_hz), "hex1")};
      estimator.update(frame);
      tracked += estimator.states().vehicles[0].tracked ? 1 : 0;
    }
    EXPECT_GE(tracked, 10 * rate_hz - std::max(4, rate_hz / 10)) << rate_hz << " Hz";
  }
}

// The network keeps back 0.2 s of frames, in which the system exchanges two small vehicles.
TEST(StateEstimator, WhoIsExchangedWhileTheNetworkIsSilentIsNotBelieved) {
  config::Experiment experiment = experimentWith(2);
  for (config::Vehicle& vehicle : experiment.vehicles) {
    vehicle.body_radius_m = 0.08;
  }
  StateEstimator estimator(experiment, "z_up");
  test::Cameras cameras;
  const FlownPath::Truth truth = FlownPath().at(0.0);
  const auto see = [&](int frame_number, bool exchanged) {
    SourceFrame frame;
    frame.exposure_utime = kEpoch + frame_number * 5000;
    frame.bodies = {cameras.see(truth, "hex1"), cameras.see(truth, "hex2")};
    frame.bodies[1].position_m.x() += 0.2;
    if (exchanged) {
      std::swap(frame.bodies[0].name, frame.bodies[1].name);
    }
    estimator.update(frame);
  };
  for (int i = 0; i < 200; ++i) {
    see(i, false);
  }
  ASSERT_TRUE(estimator.states().vehicles[0].tracked && estimator.states().vehicles[1].tracked);
  for (int i = 240; i < 500; ++i) {
    see(i, true);
    EXPECT_FALSE(estimator.states().vehicles[0].tracked) << i;
    EXPECT_FALSE(estimator.states().vehicles[1].tracked) << i;
  }
}

// Two bodies that stand still, the second of which is uncovered a second later.
bool secondIsAcquired(double body_radius_m, const Eigen::Vector3d& beside_m) {
  config::Experiment experiment = experimentWith(2);
  for (config::Vehicle& vehicle : experiment.vehicles) {
    vehicle.body_radius_m = body_radius_m;
  }
  StateEstimator estimator(experiment, "z_up");
  test::Cameras cameras;
  const FlownPath::Truth truth = FlownPath().at(0.0);
  for (int i = 0; i < 300; ++i) {
    SourceFrame frame;
    frame.exposure_utime = kEpoch + i * 5000;
    frame.bodies = {cameras.see(truth, "hex1"), cameras.see(truth, "hex2")};
    frame.bodies[1].position_m += beside_m;
    frame.bodies[1].tracked = i >= 200;
    estimator.update(frame);
  }
  return estimator.states().vehicles[1].tracked;
}

TEST(StateEstimator, VehiclesCloseToEachOtherAreAcquired) {
  EXPECT_TRUE(secondIsAcquired(0.06, {0.13, 0.0, 0.0})) << "side by side";
  EXPECT_TRUE(secondIsAcquired(0.35, {0.0, 0.0, 0.15})) << "one on the other";
}

TEST(StateEstimator, OneBodyIsNotTwoVehicles) {
  config::Experiment experiment = experimentWith(3);
  experiment.mocap.bodies = {{"hex2", "", 17, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
  StateEstimator estimator(experiment, "z_up");
  test::Cameras cameras;
  const FlownPath path;
  for (int i = 0; i < 200; ++i) {
    SourceFrame frame;
    frame.exposure_utime = kEpoch + i * 5000;
    frame.bodies = {cameras.see(path.at(0.005 * i), "hex1"),
                    cameras.see(path.at(0.005 * i), "hex3")};
    frame.bodies[0].id = i < 100 ? 17 : 16;
    frame.bodies[1].position_m.y() += 2.0;
    estimator.update(frame);
    if (i < 100) {
      EXPECT_FALSE(estimator.states().vehicles[0].tracked);
      EXPECT_FALSE(estimator.states().vehicles[1].tracked);
      EXPECT_EQ(estimator.vehicles()[0].rival, 1U);
      EXPECT_EQ(estimator.vehicles()[1].rival, 0U);
      EXPECT_EQ(estimator.vehicles()[2].rival, std::nullopt);
    }
  }
  EXPECT_TRUE(estimator.states().vehicles[0].tracked) << "the other's body has gone";
  EXPECT_TRUE(estimator.states().vehicles[2].tracked);
}

TEST(StateEstimator, BodiesByNameByIdAndWithAnOffset) {
  config::Experiment experiment = experimentWith(2);
  experiment.mocap.bodies = {{"hex1", "Drone A", -1, {0.0, 0.0, -0.1}, {0.0, 0.0, 0.5}},
                             {"hex2", "", 17, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
  StateEstimator estimator(experiment, "z_up");
  test::Cameras cameras;
  const FlownPath path;
  FlownPath::Truth truth;
  for (int i = 0; i < 100; ++i) {
    truth = path.at(0.005 * i);
    SourceFrame frame;
    frame.exposure_utime = kEpoch + i * 5000;
    frame.bodies = {cameras.see(truth, "unknown"), cameras.see(truth, "Drone A")};
    frame.bodies[0].id = 17;
    frame.bodies[0].position_m.y() += 2.0;
    estimator.update(frame);
  }
  const auto& states = estimator.states().vehicles;
  ASSERT_TRUE(states[0].tracked);
  ASSERT_TRUE(states[1].tracked);
  const Eigen::Vector3d centre = truth.position_m + truth.orientation * Eigen::Vector3d(0, 0, -0.1);
  EXPECT_LT((states[0].position_world_m - centre).norm(), 0.003);
  const Eigen::Quaterniond nose =
      truth.orientation * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  EXPECT_LT(states[0].orientation.angularDistance(nose), 0.02);
}

}  // namespace
}  // namespace roundabout::mocap_bridge
