#include "planner/policies/drl_maca/drl_maca.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/random.h"
#include "planner/policies/drl_maca/weights.h"
#include "tests/support/drl_maca_weights.h"
#include "tests/support/startup_error.h"

namespace roundabout::planner {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

constexpr int kBeams = DrlMacaTrunk::kBeams;

struct Sweep {
  explicit Sweep(core::RandomStream& random) : ranges(kBeams) {
    for (float& range : ranges) {
      range = static_cast<float>(random.uniform(0.0, 6.0));
    }
  }
  core::RangeScan scan() const {
    return {-std::numbers::pi / 2.0, std::numbers::pi / (kBeams - 1), 6.0, ranges};
  }

  std::vector<float> ranges;
};

core::Surroundings seeing(const Sweep& sweep) {
  core::Surroundings around;
  around.scan = sweep.scan();
  return around;
}

// [channel][place], as PyTorch counts.
using Planes = std::vector<std::vector<double>>;

Planes textbookConvolution(const Planes& input, const nn::TensorFile& file, const std::string& name,
                           int width) {
  const std::vector<float>& kernel = file.tensors.at(name + "/kernel").values;
  const std::vector<float>& bias = file.tensors.at(name + "/bias").values;
  const int length = static_cast<int>(input[0].size());
  const int channels = static_cast<int>(input.size());
  const int outputs = static_cast<int>(bias.size());
  Planes output(bias.size());
  for (int out = 0; out < outputs; ++out) {
    for (int begin = -1; begin + width <= length + 1; begin += 2) {
      double sum = bias[out];
      for (int tap = 0; tap < width; ++tap) {
        for (int in = 0; in < channels; ++in) {
          const int place = begin + tap;
          if (place >= 0 && place < length) {
            sum += input[in][place] * double{kernel[(tap * channels + in) * outputs + out]};
          }
        }
      }
      output[out].push_back(std::max(sum, 0.0));
    }
  }
  return output;
}

std::vector<double> textbookDense(const std::vector<double>& input, const nn::TensorFile& file,
                                  const std::string& name) {
  const std::vector<float>& kernel = file.tensors.at(name + "/kernel").values;
  const std::vector<float>& bias = file.tensors.at(name + "/bias").values;
  std::vector<double> output;
  for (std::size_t out = 0; out < bias.size(); ++out) {
    double sum = bias[out];
    for (std::size_t in = 0; in < input.size(); ++in) {
      sum += input[in] * double{kernel[in * bias.size() + out]};
    }
    output.push_back(sum);
  }
  return output;
}

std::vector<double> textbookTrunk(const Planes& scans, const DrlMacaNetwork::OwnInputs& own,
                                  const nn::TensorFile& file, const std::string& name) {
  const Planes first = textbookConvolution(scans, file, name + "/conv1", 5);
  EXPECT_EQ(first[0].size(), 255U);
  const Planes second = textbookConvolution(first, file, name + "/conv2", 3);
  EXPECT_EQ(second[0].size(), 128U);
  std::vector<double> units;
  for (std::size_t place = 0; place < second[0].size(); ++place) {
    for (const std::vector<double>& channel : second) {
      units.push_back(channel[place]);
    }
  }
  const auto relu = [&units] {
    for (double& unit : units) {
      unit = std::max(unit, 0.0);
    }
  };
  units = textbookDense(units, file, name + "/dense1");
  relu();
  units.insert(units.end(), own.begin(), own.end());
  units = textbookDense(units, file, name + "/dense2");
  relu();
  return units;
}

void expectTextbook(const nn::TensorFile& file, const DrlMacaNetwork::Scans& scans) {
  const DrlMacaNetwork::OwnInputs own = {3.0F, -1.0F, 0.7F, 0.2F};
  DrlMacaNetwork network(toDrlMacaWeights(file, "random"));
  const DrlMacaNetwork::Output output = network.evaluate(scans, own, true);
  Planes planes;
  for (const auto& scan : scans) {
    planes.emplace_back(scan.begin(), scan.end());
  }
  const std::vector<double> actor = textbookTrunk(planes, own, file, "actor");
  EXPECT_NEAR(output.linear_mps,
              1.0 / (1.0 + std::exp(-textbookDense(actor, file, "actor/linear")[0])), 1e-5);
  EXPECT_NEAR(output.angular_radps, std::tanh(textbookDense(actor, file, "actor/angular")[0]),
              1e-5);
  const std::vector<double> critic = textbookTrunk(planes, own, file, "critic");
  EXPECT_NEAR(output.value, textbookDense(critic, file, "critic/value")[0], 1e-4);

  const DrlMacaNetwork::Output actor_only = network.evaluate(scans, own, false);
  EXPECT_EQ(actor_only.linear_mps, output.linear_mps);
  EXPECT_EQ(actor_only.angular_radps, output.angular_radps);
  EXPECT_TRUE(std::isnan(actor_only.value));
}

void scatter(DrlMacaNetwork::Scans& scans, std::size_t begin, std::size_t end,
             core::RandomStream& random) {
  for (auto& scan : scans) {
    for (std::size_t beam = begin; beam < end; ++beam) {
      scan[beam] = static_cast<float>(random.uniform(-0.5, 0.5));
    }
  }
}

DrlMacaNetwork::Scans freeScans() {
  DrlMacaNetwork::Scans scans;
  for (auto& scan : scans) {
    scan.fill(DrlMacaTrunk::kFreeBeam);
  }
  return scans;
}

TEST(DrlMacaNetwork, EqualsTheTextbookFormula) {
  core::RandomStream random(1, "scans");
  DrlMacaNetwork::Scans scans = freeScans();
  scatter(scans, 0, kBeams, random);
  expectTextbook(test::randomDrlMaca(), scans);
}

TEST(DrlMacaNetwork, EqualsTheTextbookFormulaWhateverBeamsAreFree) {
  core::RandomStream random(7, "scans");
  const nn::TensorFile file = test::randomDrlMaca();
  expectTextbook(file, freeScans());
  // Every place of a beam in the windows that see it, and both ends.
  for (const std::size_t beam : {0, 1, 2, 3, 4, 5, 6, 250, 251, 252, 253, 508, 509, 510, 511}) {
    SCOPED_TRACE(beam);
    DrlMacaNetwork::Scans scans = freeScans();
    scans[beam % 3][beam] = -0.3F;
    expectTextbook(file, scans);
  }
  for (int i = 0; i < 10; ++i) {
    SCOPED_TRACE(i);
    DrlMacaNetwork::Scans scans = freeScans();
    for (int stretch = 0; stretch < 4; ++stretch) {
      const std::size_t begin = random.index(kBeams);
      scatter(scans, begin, std::min(begin + 1 + random.index(60), std::size_t{kBeams}), random);
    }
    expectTextbook(file, scans);
  }
}

TEST(DrlMacaNetwork, RemembersNothingOfTheQueryBefore) {
  core::RandomStream random(8, "scans");
  const auto weights = toDrlMacaWeights(test::randomDrlMaca(), "random");
  DrlMacaNetwork used(weights);
  DrlMacaNetwork::Scans scans = freeScans();
  scatter(scans, 0, kBeams, random);
  used.evaluate(scans, {}, true);
  scans = freeScans();
  scatter(scans, 100, 130, random);
  EXPECT_EQ(used.evaluate(scans, {}, true).value,
            DrlMacaNetwork(weights).evaluate(scans, {}, true).value);
}

TEST(DrlMacaScans, TheFirstFillsTheStackThenTheOldestLeaves) {
  core::RandomStream random(2, "scans");
  std::vector<Sweep> sweeps;
  ScanStack stack;
  for (int i = 0; i < 5; ++i) {
    sweeps.emplace_back(random);
    ASSERT_TRUE(stack.push(sweeps.back().scan()));
    for (int age = 0; age < 3; ++age) {
      const Sweep& expected = sweeps[static_cast<std::size_t>(std::max(i - age, 0))];
      const auto& found = stack.scans()[static_cast<std::size_t>(2 - age)];
      for (std::size_t beam = 0; beam < found.size(); ++beam) {
        ASSERT_NEAR(found[beam], expected.ranges[beam] / 6.0F - 0.5F, 1e-6);
      }
    }
  }
}

TEST(DrlMacaScans, WhatHitsNothingIsSixMetresAway) {
  core::RandomStream random(3, "scans");
  for (const float nothing : {6.0F, 40.0F, std::numeric_limits<float>::infinity()}) {
    Sweep sweep(random);
    sweep.ranges.assign(kBeams, nothing);
    ScanStack stack;
    ASSERT_TRUE(stack.push(sweep.scan()));
    EXPECT_THAT(stack.scans()[0], Each(0.5F));
  }
  Sweep shorter(random);
  shorter.ranges.assign(kBeams, 4.0F);
  core::RangeScan scan = shorter.scan();
  scan.max_range_m = 4.0;
  ScanStack stack;
  ASSERT_TRUE(stack.push(scan));
  EXPECT_THAT(stack.scans()[0], Each(0.5F));
}

TEST(DrlMacaScans, WhatWasNotMeasuredIsNoFreeSpace) {
  core::RandomStream random(5, "scans");
  Sweep sweep(random);
  sweep.ranges.assign(kBeams, 1.5F);
  std::fill_n(sweep.ranges.begin() + 7, 20, std::numeric_limits<float>::quiet_NaN());
  ScanStack stack;
  ASSERT_TRUE(stack.push(sweep.scan()));
  EXPECT_THAT(stack.scans()[0], Each(1.5F / 6.0F - 0.5F));
  std::fill_n(sweep.ranges.begin(), 60, std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(stack.push(sweep.scan())) << "a covered sensor";
}

TEST(DrlMacaScans, ComeFromAnyLidarThatCoversTheField) {
  core::RandomStream random(4, "scans");
  const Sweep sweep(random);
  // The same beams among those of a full circle, in the other direction.
  std::vector<float> circle(2 * (kBeams - 1), 1.0F);
  for (std::size_t i = 0; i < kBeams; ++i) {
    circle[100 + i] = sweep.ranges[kBeams - 1 - i];
  }
  const double step_rad = std::numbers::pi / (kBeams - 1);
  ScanStack ours;
  ScanStack others;
  ASSERT_TRUE(ours.push(sweep.scan()));
  ASSERT_TRUE(others.push({std::numbers::pi / 2.0 + 100 * step_rad, -step_rad, 6.0, circle}));
  EXPECT_EQ(others.scans(), ours.scans());
  EXPECT_FALSE(others.push({-1.5, step_rad, 6.0, sweep.ranges}));
  EXPECT_FALSE(others.push({}));
  EXPECT_EQ(others.scans(), ours.scans());
}

TEST(DrlMaca, StandsWithoutAScan) {
  DrlMaca policy(toDrlMacaWeights(test::randomDrlMaca(), "random"));
  EXPECT_TRUE(policy.needsScan());
  core::EgoAgent ego;
  ego.goal_world_m = {5.0, 0.0};
  const Decision decision = policy.decide(ego, {});
  EXPECT_EQ(decision.speed_mps, 0.0);
  EXPECT_EQ(decision.heading_change_rad, 0.0);
}

TEST(DrlMaca, NoticesThatItTurnedAndForgetsItOnReset) {
  DrlMaca policy(toDrlMacaWeights(test::randomDrlMaca(), "random"));
  core::RandomStream random(5, "scans");
  const Sweep sweep(random);
  core::EgoAgent ego;
  ego.goal_world_m = {5.0, 0.0};
  const double still = policy.decide(ego, seeing(sweep)).value;
  EXPECT_EQ(policy.decide(ego, seeing(sweep)).value, still);
  ego.heading_world_rad = 0.05;
  ego.goal_world_m = Eigen::Vector2d(5.0 * std::cos(0.05), 5.0 * std::sin(0.05));
  EXPECT_GT(std::abs(policy.decide(ego, seeing(sweep)).value - still), 1e-3);
  policy.reset();
  EXPECT_NEAR(policy.decide(ego, seeing(sweep)).value, still, 1e-5);
}

TEST(DrlMaca, TurnsByItsRateTimesTheStepAndKeepsToItsPreferredSpeed) {
  nn::TensorFile file = test::randomDrlMaca();
  file.tensors["actor/linear/bias"].values = {100.0F};
  file.tensors["actor/angular/bias"].values = {100.0F};
  DrlMaca policy(toDrlMacaWeights(file, "random"));
  core::RandomStream random(6, "scans");
  const Sweep sweep(random);
  core::EgoAgent ego;
  ego.preferred_speed_mps = 2.0;
  const Decision fast = policy.decide(ego, seeing(sweep));
  EXPECT_DOUBLE_EQ(fast.speed_mps, 1.0);
  EXPECT_DOUBLE_EQ(fast.heading_change_rad, 0.1);
  ego.preferred_speed_mps = 0.5;
  EXPECT_EQ(policy.decide(ego, seeing(sweep)).speed_mps, 0.5);
}

TEST(DrlMacaWeightFile, OfAnotherScannerOrShapeIsRefused) {
  const auto errorOf = [](const nn::TensorFile& file) {
    return test::startupErrorOf([&] { toDrlMacaWeights(file, "net"); });
  };
  nn::TensorFile file = test::randomDrlMaca();
  EXPECT_EQ(errorOf(file), "");
  file.metadata["beams"] = "360";
  EXPECT_EQ(errorOf(file), "net: metadata beams: expected 512, found 360");
  file = test::randomDrlMaca();
  file.tensors["critic/conv1/kernel"].shape = {32, 15};
  EXPECT_EQ(errorOf(file),
            "net: tensor critic/conv1/kernel: expected shape [15, 32], found shape [32, 15]");
  file.metadata.erase("max_range_m");
  EXPECT_THAT(errorOf(file), HasSubstr("metadata max_range_m: expected to be there"));
}

}  // namespace
}  // namespace roundabout::planner
