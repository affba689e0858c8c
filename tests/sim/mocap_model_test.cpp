#include "sim/mocap_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mocap_bridge/estimation/state_estimator.h"

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
  std::vector<core::StatesFrame> expose(int count, MocapOutput output = MocapOutput::kStates) {
    MocapModel mocap(experiment_, kStepUs, output);
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
  experiment_.mocap.filter.coast_s = 1000.0;  // tracked with the next measurement
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
  experiment_.mocap.filter.coast_s = 0.0;
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

TEST_F(MocapModelTest, PredictsWhileHiddenForAShortTime) {
  experiment_.sim.mocap.dropout = {1.0, 0.2};
  experiment_.sim.mocap.position_noise_m = 0.0;
  experiment_.sim.mocap.orientation_noise_rad = 0.0;
  const auto frames = expose(5000);
  int predicted = 0;
  for (std::size_t k = 200; k < frames.size(); ++k) {
    const core::VehicleState& state = frames[k].vehicles[0];
    ASSERT_FALSE(state.tracked && state.predicted);
    if (state.predicted) {
      const double time_s = static_cast<double>(k) * kStepS;
      ASSERT_NEAR(state.position_world_m.x(), time_s, 1e-3);
      ASSERT_NEAR(std::remainder(core::headingOf(state.orientation) - 0.5 * time_s, 6.2831853072),
                  0.0, 1e-3);
      ++predicted;
    }
  }
  EXPECT_GT(predicted, 100);
}

struct Faults {
  double rate_hz;
  config::MocapFault dropout;
  config::MocapFault flip;
  config::MocapFault swap;
};

// What a bridge behind the same cameras says, from when it has acquired everybody. One fault at a
// time: it cannot know a flip that begins while a vehicle is hidden.
class AsTheBridge : public MocapModelTest, public testing::WithParamInterface<Faults> {};

TEST_P(AsTheBridge, SaysWhoIsTrackedAndWhoIsPredicted) {
  experiment_.vehicles[0].top_speed_mps = 2.0;
  experiment_.sim.mocap.rate_hz = GetParam().rate_hz;
  experiment_.sim.mocap.dropout = GetParam().dropout;
  experiment_.sim.mocap.flip = GetParam().flip;
  experiment_.sim.mocap.swap = GetParam().swap;
  const auto count = static_cast<int>(100 * GetParam().rate_hz);
  const auto frames = expose(count);
  mocap_bridge::StateEstimator bridge(experiment_, "z_up");
  int lost = 0;
  int predicted = 0;
  int different = 0;
  const auto scenes = expose(count, MocapOutput::kScene);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    mocap_bridge::SourceFrame seen;
    seen.number = scenes[k].frame_number;
    seen.exposure_utime = scenes[k].utime + 1;
    for (const core::VehicleState& state : scenes[k].vehicles) {
      seen.bodies.push_back(
          {state.name, -1, state.position_world_m, state.orientation, state.tracked, 0.0005});
    }
    bridge.update(seen);
    if (scenes[k].utime < 10 * core::kMicrosPerSecond) {
      continue;  // it has not seen everybody from the start, and they begin at one place
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const core::VehicleState& simulated = frames[k].vehicles[i];
      const core::VehicleState& bridged = bridge.states().vehicles[i];
      different += simulated.tracked != bridged.tracked || simulated.predicted != bridged.predicted;
      predicted += simulated.predicted ? 1 : 0;
      lost += !simulated.predicted && !simulated.tracked ? 1 : 0;
      if (simulated.tracked && bridged.tracked) {
        ASSERT_NEAR((simulated.position_world_m - bridged.position_world_m).norm(), 0.0, 0.01);
      }
    }
  }
  EXPECT_EQ(predicted > count / 50, GetParam().rate_hz > 10.0);  // coasts for 0.1 s
  EXPECT_GT(lost, count / 50);
  EXPECT_EQ(different, 0);
}

INSTANTIATE_TEST_SUITE_P(Rates, AsTheBridge,
                         testing::Values(Faults{200.0, {1.0, 0.1}, {}, {}},
                                         Faults{100.0, {1.0, 0.1}, {}, {}},
                                         Faults{5.0, {0.5, 0.5}, {}, {}},
                                         Faults{200.0, {}, {1.0, 0.1}, {}},
                                         Faults{200.0, {}, {}, {1.0, 0.1}}));

TEST_F(MocapModelTest, ShowsSwapsAndFlipsToABridgeOnly) {
  experiment_.sim.mocap.flip = {0.5, 0.1};
  experiment_.sim.mocap.swap = {0.5, 0.1};
  const int count = 100'000;
  int exchanged = 0;
  int flipped = 0;
  for (const core::StatesFrame& frame : expose(count, MocapOutput::kScene)) {
    const core::VehicleState& state = frame.vehicles[0];
    const double time_s = core::toSeconds(frame.utime);
    const bool elsewhere = std::abs(state.position_world_m.x() - time_s) > 0.01;
    ASSERT_TRUE(state.tracked);
    exchanged += elsewhere ? 1 : 0;
    flipped +=
        !elsewhere && std::abs(std::remainder(core::headingOf(state.orientation) - 0.5 * time_s,
                                              6.2831853072)) > 1.0;
    ASSERT_EQ(elsewhere, time_s > 0.1 && frame.vehicles[1].position_world_m.norm() > 0.05);
  }
  // In half a fault a second, 0.1 s each, begun only once the last is over.
  EXPECT_NEAR(exchanged, count / 21.0, count / 100.0);
  EXPECT_NEAR(flipped, count / 21.0, count / 100.0);
  for (const core::StatesFrame& frame : expose(count)) {
    ASSERT_NEAR(frame.vehicles[0].position_world_m.x(), core::toSeconds(frame.utime), 2.0);
    ASSERT_NEAR(frame.vehicles[1].position_world_m.norm(), 0.0, 0.05);
  }
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
