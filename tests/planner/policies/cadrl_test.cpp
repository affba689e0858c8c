#include "planner/policies/cadrl/cadrl.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/policies/cadrl/encounter.h"
#include "planner/policies/cadrl/joint_state.h"
#include "planner/policies/cadrl/published.h"
#include "planner/policies/cadrl/weights.h"
#include "tests/planner/policies/random_scene.h"
#include "tests/support/cadrl_weights.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"

namespace roundabout::planner {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;

std::shared_ptr<const CadrlWeights> randomNetwork() {
  return toCadrlWeights(test::randomCadrl(), "random");
}

Scene sceneWithIds(core::RandomStream& random, std::size_t num_others) {
  Scene scene = randomScene(random, num_others, 4.0);
  for (std::size_t i = 0; i < num_others; ++i) {
    scene.others[i].id = static_cast<int>(10 * i);
  }
  return scene;
}

TEST(Cadrl, TakesTheMeanOfTheLastTwoVelocitiesOfWhomItKnows) {
  core::RandomStream random(1, "scenes");
  for (int i = 0; i < 100; ++i) {
    Scene scene = sceneWithIds(random, 3);
    Cadrl policy(randomNetwork());
    policy.decide(scene.ego, scene.others);
    Scene later = scene;
    Scene mean = scene;
    for (std::size_t k = 0; k < later.others.size(); ++k) {
      later.others[k].velocity_world_mps = randomVector(random, 1.0);
      mean.others[k].velocity_world_mps =
          (scene.others[k].velocity_world_mps + later.others[k].velocity_world_mps) / 2.0;
    }
    // Known by their ids, in whatever order they come.
    std::reverse(later.others.begin(), later.others.end());
    EXPECT_EQ(policy.decide(later.ego, later.others).value,
              Cadrl(randomNetwork()).decide(mean.ego, mean.others).value);

    policy.reset();
    EXPECT_EQ(policy.decide(later.ego, later.others).value,
              Cadrl(randomNetwork()).decide(later.ego, later.others).value);
  }
}

TEST(Cadrl, WhoHasNoIdHasNoPast) {
  core::RandomStream random(2, "scenes");
  Cadrl policy(randomNetwork());
  for (int i = 0; i < 100; ++i) {
    const Scene scene = randomScene(random, 3, 4.0);
    EXPECT_EQ(policy.decide(scene.ego, scene.others).value,
              Cadrl(randomNetwork()).decide(scene.ego, scene.others).value);
  }
}

TEST(Cadrl, SeesTheThreeNearest) {
  core::RandomStream random(3, "scenes");
  for (int i = 0; i < 100; ++i) {
    Scene scene = sceneWithIds(random, 3);
    const Decision three = Cadrl(randomNetwork()).decide(scene.ego, scene.others);
    scene.others.push_back(
        {scene.ego.position_world_m + Vector2d(20.0, 0.0), Vector2d(0.0, 0.0), 0.5, 99});
    const Decision four = Cadrl(randomNetwork()).decide(scene.ego, scene.others);
    EXPECT_EQ(four.value, three.value);
    EXPECT_EQ(four.neighbours_used, 3);
  }
}

TEST(Cadrl, GoesStraightToItsGoalWhenAlone) {
  core::EgoAgent ego;
  ego.goal_world_m = {0.0, 5.0};
  const Decision decision = Cadrl(randomNetwork()).decide(ego, {});
  EXPECT_EQ(decision.speed_mps, ego.preferred_speed_mps);
  EXPECT_DOUBLE_EQ(decision.heading_change_rad, std::numbers::pi / 2.0);
}

TEST(Cadrl, WhereTheWorldsOriginIsDoesNotMatter) {
  core::RandomStream random(4, "scenes");
  for (int i = 0; i < 100; ++i) {
    const Scene scene = randomScene(random, 3, 4.0);
    Scene moved = scene;
    const Vector2d shift = randomVector(random, 20.0);
    moved.ego.position_world_m += shift;
    moved.ego.goal_world_m += shift;
    for (core::OtherAgent& other : moved.others) {
      other.position_world_m += shift;
    }
    EXPECT_NEAR(Cadrl(randomNetwork()).decide(moved.ego, moved.others).value,
                Cadrl(randomNetwork()).decide(scene.ego, scene.others).value, 1e-4);
  }
}

TEST(CadrlEncounter, ComesAsCloseAsTheSampledWay) {
  core::RandomStream random(5, "scenes");
  constexpr int kSamples = 1000;
  constexpr double kDurationS = 0.8;
  for (int i = 0; i < 300; ++i) {
    const Scene scene = randomScene(random, 1, 2.0);
    core::EgoAgent ego = scene.ego;
    ego.preferred_speed_mps = 1.5;
    const core::OtherAgent& other = scene.others[0];
    for (const Candidate& candidate : candidatesOf(ego)) {
      // Whoever comes towards the ego, or stands, is not taken for slower.
      if (candidate.velocity_world_mps.dot(other.velocity_world_mps) > 0.0) {
        continue;
      }
      const Encounter encounter = encounterWith(other, ego, candidate, kDurationS);
      const Vector2d offset = other.position_world_m - ego.position_world_m;
      const Vector2d velocity = other.velocity_world_mps - candidate.velocity_world_mps;
      // Who moves apart is as far as at the end.
      double closest = (offset + kDurationS * velocity).norm();
      for (int k = 1; k < kSamples && offset.dot(velocity) < 0.0; ++k) {
        closest = std::min(closest, (offset + kDurationS * k / kSamples * velocity).norm());
      }
      closest -= ego.radius_m + other.radius_m;
      const double gap_m =
          (other.position_world_m - ego.position_world_m).norm() - ego.radius_m - other.radius_m;
      if (gap_m > kDurationS * (ego.preferred_speed_mps + other.velocity_world_mps.norm())) {
        EXPECT_FALSE(encounter.collides);
        EXPECT_GE(closest, 0.0);
        EXPECT_GT(encounter.closest_gap_m, kCadrlCloseM);
      } else {
        EXPECT_NEAR(encounter.closest_gap_m, closest, 2e-3);
        EXPECT_EQ(encounter.collides, encounter.closest_gap_m < 0.0 || gap_m < 0.0);
      }
    }
  }
}

// The published matrices, one number after the other.
double textbookValue(const nn::TensorFile& file, const JointState& state) {
  std::vector<double> units;
  const auto tensor = [&](const char* name) { return file.tensors.at(name).values; };
  for (const float number : state.own) {
    units.push_back(number);
  }
  for (const auto& other : state.others) {
    units.insert(units.end(), other.begin(), other.end());
  }
  for (std::size_t i = 0; i < units.size(); ++i) {
    units[i] = (units[i] - tensor("input_avg")[i]) / tensor("input_std")[i];
  }
  const auto dense = [&](const char* kernel, const char* bias) {
    std::vector<double> out;
    const std::vector<float> weights = tensor(kernel);
    const std::vector<float> biases = tensor(bias);
    for (std::size_t j = 0; j < biases.size(); ++j) {
      out.push_back(biases[j]);
      for (std::size_t i = 0; i < units.size(); ++i) {
        out[j] += units[i] * double{weights[i * biases.size() + j]};
      }
    }
    units = out;
  };
  const auto relu = [&] {
    for (double& unit : units) {
      unit = std::max(unit, 0.0);
    }
  };
  dense("W0", "b0");
  relu();
  dense("W1", "b1");
  relu();
  for (std::size_t i = 50; i < 100; ++i) {
    units[i] = std::max({units[i], units[i + 50], units[i + 100]});
  }
  units.resize(100);
  dense("W3", "b3");
  relu();
  dense("W4", "b4");
  return units[0] * tensor("output_std")[0] + tensor("output_avg")[0];
}

TEST(CadrlNetwork, EqualsTheTextbookFormulaForEveryNumberOfOthersAndStates) {
  const nn::TensorFile published = test::randomPublishedCadrl();
  CadrlNetwork network(toCadrlWeights(importPublishedCadrl(published, "random"), "random"));
  core::RandomStream random(6, "states");
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{47}}) {
    std::vector<JointState> states;
    for (std::size_t i = 0; i < count; ++i) {
      const Scene scene = randomScene(random, 1 + i % 3, 3.0);
      states.push_back(jointState(scene.ego, scene.others));
    }
    const std::span<const float> values = network.evaluate(states);
    ASSERT_EQ(values.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NEAR(values[i], textbookValue(published, states[i]), 1e-5) << i << " of " << count;
    }
  }
}

class CadrlWeightFile : public ::testing::Test {
 protected:
  std::string errorOf(const nn::TensorFile& file) const {
    nn::writeSafetensors(path_, file);
    return test::startupErrorOf([this] { readCadrlWeights(path_); });
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_ / "cadrl.safetensors";
};

TEST_F(CadrlWeightFile, MayBeAPublishedNetwork) {
  nn::writeSafetensors(path_, test::randomPublishedCadrl());
  const auto published = readCadrlWeights(path_);
  nn::writeSafetensors(path_, test::randomCadrl());
  const auto ours = readCadrlWeights(path_);
  EXPECT_EQ(published->layer1.joint, ours->layer1.joint);
  EXPECT_EQ(published->layer2.self, ours->layer2.self);
  EXPECT_EQ(published->other_deviation, ours->other_deviation);
  EXPECT_EQ(published->value_kernel, ours->value_kernel);
}

TEST_F(CadrlWeightFile, ThatTreatsOthersDifferentlyIsRefused) {
  nn::TensorFile file = test::randomPublishedCadrl();
  file.tensors["W1"].values.back() += 1.0F;
  EXPECT_EQ(errorOf(file), path_ +
                               ": tensor W1: expected the same weights for every other agent, "
                               "found different ones");
  file = test::randomPublishedCadrl();
  file.tensors["input_avg"].values.back() += 1.0F;
  EXPECT_THAT(errorOf(file), HasSubstr("tensor input_avg: expected the same numbers for every"));
}

TEST_F(CadrlWeightFile, OfAnotherShapeIsRefused) {
  nn::TensorFile file = test::randomPublishedCadrl();
  file.tensors["b3"] = {{50}, std::vector<float>(50)};
  EXPECT_EQ(errorOf(file), path_ + ": tensor b3: expected shape [1, 50], found shape [50]");
  file = test::randomCadrl();
  file.tensors.erase("value/bias");
  EXPECT_EQ(errorOf(file), path_ + ": tensor value/bias: expected shape [1], found no such tensor");
}

TEST_F(CadrlWeightFile, OfAnotherArchitectureIsRefused) {
  nn::TensorFile file = test::randomCadrl();
  file.metadata["architecture"] = "ga3c_cadrl_lstm";
  EXPECT_EQ(errorOf(file), path_ +
                               ": metadata architecture: expected \"sa_cadrl_value\", found "
                               "\"ga3c_cadrl_lstm\"");
}

}  // namespace
}  // namespace roundabout::planner
