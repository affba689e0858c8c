#include "learning/training/ppo_loss.h"

#include <cmath>

#include <gtest/gtest.h>

#include "learning/training/ga3c_loss.h"

namespace roundabout::learning {
namespace {

// One sample whose policy was uniform.
Samples uniformSample(float sharpness, float ratio_before = 1.0F) {
  Samples samples;
  samples.add({});
  samples.action[0] = 4;
  samples.sharpness[0] = sharpness;
  samples.log_probability[0] = std::log(ratio_before / kActionCount);
  samples.target[0] = 0.25F;
  return samples;
}

// The loss itself, in double precision.
double lossOf(const Ppo& ppo, double entropy_weight, const Samples& samples, double advantage,
              const HeadsRow& heads) {
  const double sharpness = samples.sharpness[0];
  double sum = 0.0;
  for (int a = 0; a < kActionCount; ++a) {
    sum += std::exp(sharpness * heads[a]);
  }
  double entropy = 0.0;
  const auto logOf = [&](int a) { return sharpness * heads[a] - std::log(sum); };
  for (int a = 0; a < kActionCount; ++a) {
    entropy -= std::exp(logOf(a)) * logOf(a);
  }
  const double ratio = std::exp(logOf(samples.action[0]) - samples.log_probability[0]);
  const double clipped = std::clamp(ratio, 1.0 - ppo.clip, 1.0 + ppo.clip);
  const double error = heads[kActionCount] - samples.target[0];
  return -std::min(ratio * advantage, clipped * advantage) +
         0.5 * ppo.value_weight * error * error - entropy_weight * entropy;
}

TEST(PpoLoss, GradientIsTheSlopeOfTheDefinition) {
  const Ppo ppo;
  HeadsRow heads;
  heads << 0.1F, -0.2F, 0.3F, 0.0F, 0.05F, -0.1F, 0.2F, 0.15F, -0.3F, 0.1F, 0.0F, 0.6F;
  for (const float sharpness : {1.0F, 2.0F}) {
    for (const float before : {1.0F, 0.5F, 2.0F}) {
      for (const float advantage : {1.5F, -0.7F}) {
        const Samples samples = uniformSample(sharpness, before);
        HeadsRow d_heads;
        ppoLoss(ppo, 0.01, samples, 0, advantage, heads, d_heads);
        for (int k = 0; k < kHeads; ++k) {
          constexpr float kStep = 1e-3F;
          HeadsRow up = heads;
          HeadsRow down = heads;
          up[k] += kStep;
          down[k] -= kStep;
          const double slope = (lossOf(ppo, 0.01, samples, advantage, up) -
                                lossOf(ppo, 0.01, samples, advantage, down)) /
                               static_cast<double>(up[k] - down[k]);
          EXPECT_NEAR(d_heads[k], slope, 1e-4) << "head " << k;
        }
      }
    }
  }
}

TEST(PpoLoss, SaysHowFarThePolicyHasMoved) {
  HeadsRow heads = HeadsRow::Zero();
  HeadsRow d_heads;
  const LossFigures still = ppoLoss({}, 0.0, uniformSample(1.0F), 0, 1.0F, heads, d_heads);
  EXPECT_NEAR(still.divergence, 0.0, 1e-6);
  EXPECT_NEAR(still.entropy, std::log(11.0), 1e-5);
  EXPECT_EQ(still.clipped, 0.0);
  heads[4] = 2.0F;
  const LossFigures moved = ppoLoss({}, 0.0, uniformSample(1.0F), 0, 1.0F, heads, d_heads);
  EXPECT_GT(moved.divergence, 0.1);
  EXPECT_EQ(moved.clipped, 1.0);
}

TEST(Ga3cLoss, GradientIsTheSlopeOfTheDefinition) {
  HeadsRow heads;
  heads << 0.1F, -0.2F, 0.3F, 0.0F, 0.05F, -0.1F, 0.2F, 0.15F, -0.3F, 0.1F, 0.0F, 0.6F;
  constexpr double kEntropyWeight = 0.01;
  constexpr int kAction = 4;
  constexpr double kTarget = 0.25;
  const double advantage = kTarget - static_cast<double>(heads[kActionCount]);
  const auto lossAt = [&](const HeadsRow& at) {
    const Eigen::Array<double, 1, kActionCount> scores =
        at.head<kActionCount>().cast<double>().array();
    const Eigen::Array<double, 1, kActionCount> logs = scores - std::log(scores.exp().sum());
    const double error = kTarget - static_cast<double>(at[kActionCount]);
    return -logs[kAction] * advantage + kEntropyWeight * (logs.exp() * logs).sum() +
           0.5 * error * error;
  };
  HeadsRow d_heads;
  ga3cLoss(kEntropyWeight, kAction, static_cast<float>(kTarget), heads, d_heads);
  for (int k = 0; k < kHeads; ++k) {
    constexpr float kStep = 1e-3F;
    HeadsRow up = heads;
    HeadsRow down = heads;
    up[k] += kStep;
    down[k] -= kStep;
    EXPECT_NEAR(d_heads[k], (lossAt(up) - lossAt(down)) / static_cast<double>(up[k] - down[k]),
                1e-4)
        << "head " << k;
  }
}

}  // namespace
}  // namespace roundabout::learning
