#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/random.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "tests/planner/policies/random_scene.h"
#include "tests/support/allocation_count.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using Numbers = std::vector<double>;

std::shared_ptr<const Ga3cCadrlWeights> randomWeights(std::uint64_t seed) {
  return toGa3cCadrlWeights(test::randomGa3cCadrl(seed), "random");
}

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

// The features, normalised, and after them `rest`.
template <class Features, class Statistics>
Numbers joined(const Features& features, const Statistics& mean, const Statistics& deviation,
               const Numbers& rest) {
  Numbers numbers(features.size() + rest.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    numbers[i] = (double{features[i]} - mean[i]) / deviation[i];
  }
  std::copy(rest.begin(), rest.end(), numbers.begin() + features.size());
  return numbers;
}

// A network as NETWORK.md and docs/formats/weights.md describe it, with plain loops over a file's
// tensors.
class PlainNetwork {
 public:
  explicit PlainNetwork(const nn::TensorFile& file) : file_(file) {}

  // The probabilities, then the value.
  Numbers evaluate(const Observation& observation) const {
    const Normalisation norm = test::unusualNormalisation();
    Numbers wide = joined(observation.ego, norm.ego_mean, norm.ego_deviation, summary(observation));
    for (const char* name : {"layer1", "layer2", "layer3"}) {
      wide = relu(layer(name, wide));
    }
    Numbers result = layer("policy", wide);
    double sum = 0.0;
    for (double& each : result) {
      each = std::exp(each);
      sum += each;
    }
    std::for_each(result.begin(), result.end(), [sum](double& each) { each /= sum; });
    result.push_back(layer("value", wide)[0]);
    return result;
  }

 private:
  Numbers summary(const Observation& observation) const {
    const std::string& architecture = file_.metadata.at("architecture");
    return architecture == kLstmArchitecture            ? lstm(observation.others)
           : architecture == kWeightSharingArchitecture ? slots(observation.others)
           : architecture == kAttentionArchitecture     ? attention(observation)
                                                        : maximum(observation);
  }

  Numbers readPair(const EgoFeatures& ego, const OtherFeatures& other) const {
    const Normalisation norm = test::unusualNormalisation();
    const Numbers pair = joined(ego, norm.ego_mean, norm.ego_deviation,
                                joined(other, norm.other_mean, norm.other_deviation, {}));
    return relu(layer("other2", relu(layer("other1", pair))));
  }

  // Four heads, of 32 units each: the mean of the others' contents, weighted by softmax(scores).
  Numbers attention(const Observation& observation) const {
    Numbers summary(128, 0.0);
    for (std::size_t head = 0; head < 4; ++head) {
      double sum = 0.0;
      for (const OtherFeatures& other : observation.others) {
        const Numbers read = readPair(observation.ego, other);
        const Numbers content = layer("content", read);
        double score = 0.0;
        for (std::size_t i = 0; i < read.size(); ++i) {
          score += read[i] * double{file_.tensors.at("score/kernel").values[4 * i + head]};
        }
        sum += std::exp(score);
        for (std::size_t k = 32 * head; k < 32 * (head + 1); ++k) {
          summary[k] += std::exp(score) * content[k];
        }
      }
      for (std::size_t k = 32 * head; k < 32 * (head + 1) && sum > 0.0; ++k) {
        summary[k] /= sum;
      }
    }
    return summary;
  }

  // The largest of each unit, over the others.
  Numbers maximum(const Observation& observation) const {
    Numbers best(128, 0.0);
    for (const OtherFeatures& other : observation.others) {
      const Numbers output = readPair(observation.ego, other);
      for (std::size_t k = 0; k < best.size(); ++k) {
        best[k] = std::max(best[k], output[k]);
      }
    }
    return best;
  }

  // The last hidden state.
  Numbers lstm(const std::vector<OtherFeatures>& others) const {
    const Normalisation norm = test::unusualNormalisation();
    Numbers hidden(64, 0.0);
    Numbers cell(64, 0.0);
    for (const OtherFeatures& other : others) {
      const Numbers gates =
          layer("lstm", joined(other, norm.other_mean, norm.other_deviation, hidden));
      for (std::size_t k = 0; k < 64; ++k) {
        cell[k] =
            sigmoid(gates[128 + k] + 1.0) * cell[k] + sigmoid(gates[k]) * std::tanh(gates[64 + k]);
        hidden[k] = sigmoid(gates[192 + k]) * std::tanh(cell[k]);
      }
    }
    return hidden;
  }

  // What the shared layer makes of every slot. An empty one holds zeros, normalised like an agent,
  // and is marked by a last input of 0 instead of 1.
  Numbers slots(const std::vector<OtherFeatures>& others) const {
    const Normalisation norm = test::unusualNormalisation();
    Numbers all;
    for (int slot = 0; slot < std::stoi(file_.metadata.at("max_others")); ++slot) {
      const bool somebody = slot < static_cast<int>(others.size());
      const OtherFeatures features =
          somebody ? others[static_cast<std::size_t>(slot)] : OtherFeatures{};
      const Numbers output =
          relu(layer("other", joined(features, norm.other_mean, norm.other_deviation,
                                     {somebody ? 1.0 : 0.0})));
      all.insert(all.end(), output.begin(), output.end());
    }
    return all;
  }

  static Numbers relu(Numbers numbers) {
    std::for_each(numbers.begin(), numbers.end(), [](double& each) { each = std::max(each, 0.0); });
    return numbers;
  }

  Numbers layer(const std::string& name, const Numbers& input) const {
    const nn::Tensor& kernel = file_.tensors.at(name + "/kernel");
    const nn::Tensor& bias = file_.tensors.at(name + "/bias");
    Numbers output(bias.values.begin(), bias.values.end());
    for (std::size_t i = 0; i < input.size(); ++i) {
      for (std::size_t j = 0; j < output.size(); ++j) {
        output[j] += input[i] * double{kernel.values[i * output.size() + j]};
      }
    }
    return output;
  }

  const nn::TensorFile& file_;
};

void expectThePlainForwardPass(const nn::TensorFile& file) {
  const PlainNetwork plain(file);
  Ga3cCadrlNetwork network(toGa3cCadrlWeights(file, "random"));
  const int max_others = network.weights()->max_others;
  core::RandomStream random(3, "scenes");
  ObservationEncoder encoder(max_others, OthersOrder::kClosestLast);
  for (std::size_t num_others = 0; num_others <= static_cast<std::size_t>(max_others);
       ++num_others) {
    const Scene scene = randomScene(random, num_others, 5.0);
    const Observation& observation = encoder.encode(scene.ego, scene.others);
    const Ga3cCadrlNetwork::Output output = network.evaluate(observation);
    const Numbers expected = plain.evaluate(observation);
    ASSERT_EQ(output.probabilities.size(), 11U);
    for (std::size_t action = 0; action < 11; ++action) {
      EXPECT_NEAR(output.probabilities[action], expected[action], 1e-5)
          << num_others << " others, action " << action;
    }
    EXPECT_NEAR(output.value, expected[11], 1e-4) << num_others << " others";
    EXPECT_EQ(output.best_action,
              std::max_element(expected.begin(), expected.end() - 1) - expected.begin());
  }
}

TEST(Ga3cCadrlNetwork, EqualsThePlainForwardPass) {
  expectThePlainForwardPass(test::randomGa3cCadrl(3));
}

TEST(Ga3cCadrlNetwork, EqualsThePlainForwardPassWhenOthersShareWeights) {
  for (const int slots : {3, 5, 7}) {
    SCOPED_TRACE(slots);
    expectThePlainForwardPass(test::randomGa3cCadrl(4, kWeightSharingArchitecture, slots));
  }
}

TEST(Ga3cCadrlNetwork, EqualsThePlainForwardPassWithAMaximumOverOthers) {
  expectThePlainForwardPass(test::randomGa3cCadrl(14, kPooledArchitecture));
}

TEST(Ga3cCadrlNetwork, EqualsThePlainForwardPassWithAttentionOverOthers) {
  expectThePlainForwardPass(test::randomGa3cCadrl(17, kAttentionArchitecture));
}

TEST(Ga3cCadrlNetwork, DoesNotCareForTheOrderOfOthersWithAMaximumOverThem) {
  Ga3cCadrlNetwork network(
      toGa3cCadrlWeights(test::randomGa3cCadrl(15, kPooledArchitecture), "pooled"));
  core::RandomStream random(15, "scene");
  const Scene scene = randomScene(random, 6, 5.0);
  ObservationEncoder encoder(19, OthersOrder::kClosestLast);
  Observation observation = encoder.encode(scene.ego, scene.others);
  const float expected = network.evaluate(observation).value;
  std::ranges::reverse(observation.others);
  EXPECT_EQ(network.evaluate(observation).value, expected);
}

TEST(Ga3cCadrlNetwork, AddsTheValueOfALoneAgentWhereTheFileSaysSo) {
  nn::TensorFile file = test::randomGa3cCadrl(16, kPooledArchitecture);
  core::RandomStream random(16, "scene");
  const Scene scene = randomScene(random, 2, 5.0);
  ObservationEncoder encoder(19, OthersOrder::kClosestLast);
  const Observation& observation = encoder.encode(scene.ego, scene.others);
  const auto value = [&] {
    return Ga3cCadrlNetwork(toGa3cCadrlWeights(file, "pooled")).evaluate(observation).value;
  };
  const float bare = value();
  file.metadata["value_baseline"] = "lone_agent";
  EXPECT_NEAR(value(), bare + loneAgentValue(observation.ego[0], observation.ego[2]), 1e-6);
}

TEST(LoneAgentValue, IsTheRewardDiscountedForTheWay) {
  EXPECT_DOUBLE_EQ(loneAgentValue(0.1, 1.0), 1.0);
  // One metre beyond the goal's radius takes five steps of 0.2 s.
  EXPECT_NEAR(loneAgentValue(1.2, 1.0), std::pow(0.97, 5.0), 1e-12);
  EXPECT_NEAR(loneAgentValue(1.2, 0.5), std::pow(0.97, 10.0), 1e-12);
}

TEST(Ga3cCadrlNetwork, TellsAnEmptySlotFromAnAgentOfZeros) {
  const auto weights =
      toGa3cCadrlWeights(test::randomGa3cCadrl(5, kWeightSharingArchitecture, 3), "shared");
  Observation nobody;
  Observation somebody;
  somebody.others = {OtherFeatures{}};
  Ga3cCadrlNetwork network(weights);
  const float alone = network.evaluate(nobody).value;
  EXPECT_NE(network.evaluate(somebody).value, alone);
}

TEST(Ga3cCadrlNetwork, AnswersAlikeForEveryAgentThatSharesItsWeights) {
  const auto weights = randomWeights(4);
  Ga3cCadrlNetwork used(weights);
  core::RandomStream random(4, "scenes");
  ObservationEncoder encoder(19, OthersOrder::kClosestLast);
  for (int trial = 0; trial < 20; ++trial) {
    const Scene scene = randomScene(random, random.index(20), 5.0);
    const Observation& observation = encoder.encode(scene.ego, scene.others);
    Ga3cCadrlNetwork fresh(weights);
    const auto expected = fresh.evaluate(observation);
    const auto found = used.evaluate(observation);
    EXPECT_EQ(found.value, expected.value);
    EXPECT_TRUE(std::equal(found.probabilities.begin(), found.probabilities.end(),
                           expected.probabilities.begin(), expected.probabilities.end()));
  }
}

TEST(Ga3cCadrlNetwork, PrefersTheFirstOfEqualActions) {
  nn::TensorFile file = test::randomGa3cCadrl(5);
  std::ranges::fill(file.tensors["policy/kernel"].values, 0.0F);
  std::ranges::fill(file.tensors["policy/bias"].values, 0.0F);
  Ga3cCadrlNetwork network(toGa3cCadrlWeights(file, "equal"));
  const auto output = network.evaluate(Observation{});
  EXPECT_EQ(output.best_action, 0);
  EXPECT_FLOAT_EQ(output.probabilities[0], 1.0F / 11.0F);
}

TEST(Ga3cCadrlNetwork, StaysFiniteWithHugeScores) {
  nn::TensorFile file = test::randomGa3cCadrl(6);
  file.tensors["policy/bias"].values[7] = 1e30F;
  Ga3cCadrlNetwork network(toGa3cCadrlWeights(file, "huge"));
  const auto output = network.evaluate(Observation{});
  EXPECT_EQ(output.best_action, 7);
  EXPECT_EQ(output.probabilities[7], 1.0F);
  EXPECT_NEAR(output.probabilities[0], 0.0F, 1e-30F);
}

// Flies the given action whatever it sees.
std::unique_ptr<Policy> policyThatChooses(std::size_t action) {
  nn::TensorFile file = test::randomGa3cCadrl(7);
  file.tensors["policy/bias"].values[action] = 1000.0F;
  return std::make_unique<Ga3cCadrl>(toGa3cCadrlWeights(file, "biased"));
}

TEST(Ga3cCadrl, TurnsEveryActionIntoItsSpeedAndHeadingChange) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  constexpr std::array<std::array<double, 2>, 11> kPaper = {{{1.0, -30.0},
                                                             {1.0, -15.0},
                                                             {1.0, 0.0},
                                                             {1.0, 15.0},
                                                             {1.0, 30.0},
                                                             {0.5, -30.0},
                                                             {0.5, 0.0},
                                                             {0.5, 30.0},
                                                             {0.0, -30.0},
                                                             {0.0, 0.0},
                                                             {0.0, 30.0}}};
  core::RandomStream random(7, "scene");
  Scene scene = randomScene(random, 2, 5.0);
  scene.ego.preferred_speed_mps = 0.8;
  for (std::size_t action = 0; action < kPaper.size(); ++action) {
    const Decision decision = policyThatChooses(action)->decide(scene.ego, scene.others);
    EXPECT_EQ(decision.action, static_cast<int>(action));
    EXPECT_DOUBLE_EQ(decision.speed_mps, kPaper[action][0] * 0.8);
    EXPECT_DOUBLE_EQ(decision.heading_change_rad, kPaper[action][1] * kDegree);
  }
}

TEST(Ga3cCadrl, ReportsWhatTheNetworkSaid) {
  const auto weights = randomWeights(8);
  Ga3cCadrl policy(weights);
  core::RandomStream random(8, "scene");
  const Scene scene = randomScene(random, 25, 5.0);
  const Decision decision = policy.decide(scene.ego, scene.others);

  ObservationEncoder encoder(19, OthersOrder::kClosestLast);
  Ga3cCadrlNetwork network(weights);
  const auto output = network.evaluate(encoder.encode(scene.ego, scene.others));
  EXPECT_EQ(decision.neighbours_used, 19);
  EXPECT_EQ(decision.value, output.value);
  EXPECT_TRUE(std::equal(decision.action_probabilities.begin(), decision.action_probabilities.end(),
                         output.probabilities.begin(), output.probabilities.end()));
}

TEST(Ga3cCadrl, ObservesNoMoreOthersThanItsNetworkWasMadeFor) {
  nn::TensorFile file = test::randomGa3cCadrl(9);
  file.metadata["max_others"] = "3";
  Ga3cCadrl policy(toGa3cCadrlWeights(file, "three"));
  core::RandomStream random(9, "scene");
  const Scene scene = randomScene(random, 5, 5.0);
  EXPECT_EQ(policy.decide(scene.ego, scene.others).neighbours_used, 3);
}

TEST(Ga3cCadrl, FeedsTheOthersInTheOrderOfItsFile) {
  core::RandomStream random(12, "scene");
  const Scene scene = randomScene(random, 6, 5.0);
  nn::TensorFile file = test::randomGa3cCadrl(12);
  for (const NamedOthersOrder& each : kOthersOrders) {
    file.metadata["others_order"] = each.name;
    const auto weights = toGa3cCadrlWeights(file, "ordered");
    ObservationEncoder encoder(19, each.order);
    Ga3cCadrlNetwork network(weights);
    const float expected = network.evaluate(encoder.encode(scene.ego, scene.others)).value;
    EXPECT_EQ(Ga3cCadrl(weights).decide(scene.ego, scene.others).value, expected) << each.name;
  }
}

void expectNoAllocationAfterTheFirstQuery(Ga3cCadrl& policy) {
  core::RandomStream random(10, "scenes");
  std::vector<Scene> scenes;
  for (std::size_t num_others = 0; num_others <= 19; ++num_others) {
    scenes.push_back(randomScene(random, num_others, 5.0));
  }
  policy.decide(scenes.back().ego, scenes.back().others);
  const std::size_t before = test::allocationCount();
  for (const Scene& scene : scenes) {
    policy.decide(scene.ego, scene.others);
  }
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(Ga3cCadrl, AllocatesNothingAfterTheFirstQuery) {
  Ga3cCadrl recurrent(randomWeights(10));
  expectNoAllocationAfterTheFirstQuery(recurrent);
  Ga3cCadrl shared(
      toGa3cCadrlWeights(test::randomGa3cCadrl(10, kWeightSharingArchitecture, 5), "shared"));
  expectNoAllocationAfterTheFirstQuery(shared);
  Ga3cCadrl pooled(toGa3cCadrlWeights(test::randomGa3cCadrl(10, kPooledArchitecture), "pooled"));
  expectNoAllocationAfterTheFirstQuery(pooled);
}

TEST(Ga3cCadrl, SharedWeightsReadTheMostImportantOthersWhenThereIsNoRoomForAll) {
  Ga3cCadrl policy(
      toGa3cCadrlWeights(test::randomGa3cCadrl(13, kWeightSharingArchitecture, 3), "shared"));
  core::RandomStream random(13, "scene");
  Scene scene = randomScene(random, 3, 3.0);
  const float expected = static_cast<float>(policy.decide(scene.ego, scene.others).value);
  core::OtherAgent far;
  far.position_world_m = {50.0, 50.0};
  scene.others.push_back(far);
  const Decision decision = policy.decide(scene.ego, scene.others);
  EXPECT_EQ(decision.neighbours_used, 3);
  EXPECT_EQ(decision.value, expected);
}

TEST(Ga3cCadrl, IsMadeFromAWeightFile) {
  const test::ScratchFolder folder;
  PolicyOptions options;
  options.weights = folder / "weights.safetensors";
  test::writeRandomGa3cCadrl(options.weights, 11);
  const std::unique_ptr<Policy> policy = makeGa3cCadrl(options);
  EXPECT_EQ(policy->name(), "ga3c_cadrl");
  core::RandomStream random(11, "scene");
  const Scene scene = randomScene(random, 4, 5.0);
  Ga3cCadrl same(randomWeights(11));
  EXPECT_EQ(policy->decide(scene.ego, scene.others).value,
            same.decide(scene.ego, scene.others).value);
}

}  // namespace
}  // namespace roundabout::planner
