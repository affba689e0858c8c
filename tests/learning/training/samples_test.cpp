#include "learning/training/samples.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/core/random.h"

namespace roundabout::learning {
namespace {

constexpr double kGamma = 0.9;
constexpr double kLambda = 0.8;

// One learner's samples, one after the other; the last one ends as `end` says.
Samples chain(std::size_t length, std::int32_t end, core::RandomStream& random) {
  Samples samples;
  for (std::size_t s = 0; s < length; ++s) {
    samples.add({});
    samples.reward[s] = static_cast<float>(random.uniform(-1.0, 1.0));
    samples.value[s] = static_cast<float>(random.uniform(-1.0, 1.0));
    samples.next[s] = s + 1 < length ? static_cast<std::int32_t>(s + 1) : end;
  }
  samples.value_beyond.back() = 0.7F;
  return samples;
}

// The definition: sum of (gamma lambda)^k delta_k.
double advantageByDefinition(const Samples& samples, std::size_t from, bool cut_off) {
  double sum = 0.0;
  for (std::size_t s = from; s < samples.size(); ++s) {
    const bool last = s + 1 == samples.size();
    const double after = !last ? samples.value[s + 1] : cut_off ? samples.value_beyond[s] : 0.0;
    const double delta = samples.reward[s] + kGamma * after - samples.value[s];
    sum += std::pow(kGamma * kLambda, static_cast<double>(s - from)) * delta;
  }
  return sum;
}

TEST(Samples, EstimateAdvantagesAsDefined) {
  core::RandomStream random(1, "samples");
  for (const bool cut_off : {false, true}) {
    Samples samples = chain(12, cut_off ? Samples::kCutOff : Samples::kTerminal, random);
    samples.estimateAdvantages(kGamma, kLambda);
    for (std::size_t s = 0; s < samples.size(); ++s) {
      EXPECT_NEAR(samples.advantage[s], advantageByDefinition(samples, s, cut_off), 1e-5);
      EXPECT_FLOAT_EQ(samples.target[s], samples.advantage[s] + samples.value[s]);
    }
  }
}

TEST(Samples, KeepTheirOthersAndTheirSuccessorsWhenAppended) {
  planner::Observation crowded;
  crowded.others = {{1.0F}, {2.0F}};
  planner::Observation other;
  other.others = {{3.0F}};
  Samples first;
  first.add(crowded);
  first.add(other);
  first.next = {1, Samples::kTerminal};
  Samples all;
  all.append(first);
  all.append(first);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all.next, (std::vector<std::int32_t>{1, Samples::kTerminal, 3, Samples::kTerminal}));
  EXPECT_EQ(all.othersOf(2).size(), 2U);
  EXPECT_EQ(all.othersOf(2)[1][0], 2.0F);
  EXPECT_EQ(all.othersOf(3)[0][0], 3.0F);
}

}  // namespace
}  // namespace roundabout::learning
