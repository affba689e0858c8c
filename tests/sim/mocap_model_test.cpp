#include "sim/mocap_model.h"

#include <cmath>

#include <gtest/gtest.h>

namespace roundabout::sim {
namespace {

constexpr core::Utime kStepUs = 5000;
constexpr double kStepS = 0.005;

config::Experiment twoVehicles() {
  config::Experiment experiment;
  experiment.vehicles.resize(2);
  experiment.vehicles[0].name = "hex1";
  experiment.vehicles[1].name = "hex2";
  return experiment;
}

// Moves hex1 along x at 1 m/s and turns it at 0.5 rad/s; hex2 rests at the origin.
std::vector<BodyState> truthAt(double time_s) {
  std::vector<BodyState> truth(2);
  truth[0].position_world_m.x() = time_s;
  truth[0].velocity_world_mps.x() = 1.0;
  truth[0].orientation = Eigen::AngleAxisd(0.5 * time_s, Eigen::Vector3d::UnitZ());
  return truth;
}

class MocapModelTest : public testing::Test {
 protected:
  config::Experiment experiment_ = twoVehicles();

  /// Frames 0 to count - 1 of the motion above; latency and noise from experiment_.
  std::vector<core::StatesFrame> expose(int count) {
    MocapModel mocap(experiment_, kStepUs);
    std::vector<core::StatesFrame> frames;
    core::Utime now = 0;
    mocap.observe(now, truthAt(0.0));
    for (int k = 0; k < count; ++k) {
      const core::Utime utime = k * mocap.frameIntervalUs();
      while (now < utime + mocap.latencyUs()) {
        now += kStepUs;
        mocap.observe(now, truthAt(core::toSeconds(now)));
      }
      frames.push_back(mocap.expose(utime));
    }
    return frames;
  }
};

TEST_F(MocapModelTest, NumbersFramesAndStampsThemWithTheirExposure) {
  const auto frames = expose(3);
  EXPECT_EQ(frames[2].frame_number, 2);
  EXPECT_EQ(frames[2].utime, 10'000);
}

TEST_F(MocapModelTest, ShowsTheTruthOfTheExposureWhateverTheLatency) {
  experiment_.sim.mocap.position_noise_m = 0.0;
  for (const double latency_s : {0.0, 0.005, 0.03}) {
    experiment_.sim.mocap.latency_s = latency_s;
    const auto frames = expose(20);
    EXPECT_NEAR(frames[19].vehicles[0].position_world_m.x(), 19 * kStepS, 1e-12);
  }
}

TEST_F(MocapModelTest, TakesEverySecondStepForHalfTheRate) {
  experiment_.sim.mocap.position_noise_m = 0.0;
  experiment_.sim.mocap.rate_hz = 100.0;
  EXPECT_NEAR(expose(10)[9].vehicles[0].position_world_m.x(), 0.09, 1e-12);
}

TEST_F(MocapModelTest, AddsNoiseOfTheGivenDeviation) {
  experiment_.sim.mocap.position_noise_m = 0.001;
  experiment_.sim.mocap.orientation_noise_rad = 0.01;
  const auto frames = expose(20000);
  double position_sum = 0.0;
  double position_squares = 0.0;
  double angle_squares = 0.0;
  for (const core::StatesFrame& frame : frames) {
    const core::VehicleState& resting = frame.vehicles[1];
    position_sum += resting.position_world_m.y();
    position_squares += resting.position_world_m.y() * resting.position_world_m.y();
    const double angle = 2.0 * resting.orientation.x();
    angle_squares += angle * angle;
  }
  const auto count = static_cast<double>(frames.size());
  EXPECT_NEAR(position_sum / count, 0.0, 3e-5);
  EXPECT_NEAR(std::sqrt(position_squares / count), 0.001, 2e-5);
  EXPECT_NEAR(std::sqrt(angle_squares / count), 0.01, 2e-4);
}

TEST_F(MocapModelTest, EstimatesVelocitiesFromPosesAlone) {
  experiment_.sim.mocap.position_noise_m = 0.0;
  experiment_.sim.mocap.orientation_noise_rad = 0.0;
  const auto frames = expose(100);
  EXPECT_EQ(frames[0].vehicles[0].velocity_world_mps.norm(), 0.0);
  EXPECT_NEAR(frames[99].vehicles[0].velocity_world_mps.x(), 1.0, 1e-6);
  EXPECT_NEAR(frames[99].vehicles[0].angular_velocity_body_radps.z(), 0.5, 1e-6);
}

TEST_F(MocapModelTest, VelocityEstimateLagsByTheFilter) {
  experiment_.sim.mocap.position_noise_m = 0.0;
  const auto frames = expose(20);
  const double share = 1.0 - std::exp(-kStepS / experiment_.sim.mocap.velocity_filter_s);
  EXPECT_NEAR(frames[1].vehicles[0].velocity_world_mps.x(), share, 1e-9);
}

TEST_F(MocapModelTest, VelocityIsAsNoisyAsTheFilterLetsThrough) {
  const auto frames = expose(20000);
  double squares = 0.0;
  for (std::size_t k = 100; k < frames.size(); ++k) {
    squares += std::pow(frames[k].vehicles[1].velocity_world_mps.x(), 2);
  }
  // Filtered difference of white noise: sigma / T * a * sqrt(2 / (2 - a)).
  const double share = 1.0 - std::exp(-kStepS / experiment_.sim.mocap.velocity_filter_s);
  const double expected =
      experiment_.sim.mocap.position_noise_m / kStepS * share * std::sqrt(2.0 / (2.0 - share));
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(frames.size() - 100)), expected,
              0.05 * expected);
}

TEST_F(MocapModelTest, SeesEverybodyWithoutDropout) {
  for (const core::StatesFrame& frame : expose(2000)) {
    ASSERT_TRUE(frame.vehicles[0].tracked && frame.vehicles[1].tracked);
  }
}

TEST_F(MocapModelTest, HidesAsOftenAndAsLongAsTheDropoutSays) {
  experiment_.sim.mocap.dropout = {0.5, 0.2};
  int hidden_frames = 0;
  int dropouts = 0;
  bool tracked = true;
  const auto frames = expose(200'000);
  for (const core::StatesFrame& frame : frames) {
    const bool now_tracked = frame.vehicles[0].tracked;
    dropouts += tracked && !now_tracked ? 1 : 0;
    hidden_frames += now_tracked ? 0 : 1;
    tracked = now_tracked;
  }
  const double seconds = static_cast<double>(frames.size()) * kStepS;
  const double hidden_s = hidden_frames * kStepS;
  EXPECT_NEAR(dropouts / (seconds - hidden_s), 0.5, 0.06);
  EXPECT_NEAR(hidden_s / dropouts, 0.2, 0.03);
}

TEST_F(MocapModelTest, KeepsTheLastEstimateWhileHidden) {
  experiment_.sim.mocap.dropout = {1.0, 0.2};
  const auto frames = expose(5000);
  int compared = 0;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const core::VehicleState& state = frames[k].vehicles[0];
    if (!state.tracked) {
      ASSERT_EQ(state.position_world_m, frames[k - 1].vehicles[0].position_world_m);
      ASSERT_EQ(state.velocity_world_mps, frames[k - 1].vehicles[0].velocity_world_mps);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST_F(MocapModelTest, VelocityDoesNotJumpAfterAGap) {
  experiment_.sim.mocap.dropout = {1.0, 0.2};
  experiment_.sim.mocap.position_noise_m = 0.0;
  const auto frames = expose(5000);
  for (std::size_t k = 200; k < frames.size(); ++k) {
    ASSERT_NEAR(frames[k].vehicles[0].velocity_world_mps.x(), 1.0, 1e-3);
  }
}

TEST_F(MocapModelTest, OneVehiclesNoiseDoesNotDependOnTheOthers) {
  const auto both = expose(50);
  experiment_.vehicles[0].name = "another";
  const auto changed = expose(50);
  EXPECT_EQ(both[49].vehicles[1].position_world_m, changed[49].vehicles[1].position_world_m);
  EXPECT_NE(both[49].vehicles[0].position_world_m, changed[49].vehicles[0].position_world_m);
}

TEST_F(MocapModelTest, ChangesWithTheSeed) {
  const auto frames = expose(5);
  experiment_.seed = 2;
  EXPECT_NE(frames[4].vehicles[0].position_world_m, expose(5)[4].vehicles[0].position_world_m);
}

}  // namespace
}  // namespace roundabout::sim
