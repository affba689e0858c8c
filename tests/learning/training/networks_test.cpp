#include "learning/training/networks.h"

#include <cmath>

#include <gtest/gtest.h>

#include "learning/training/scores.h"
#include "learning/training/sorted_batch.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "tests/planner/policies/random_scene.h"

namespace roundabout::learning {
namespace {

// Heads that differ from each other, unlike those that training begins with.
Parameters someParameters(const ParameterLayout& layout) {
  core::RandomStream random(1, "parameters");
  Parameters parameters = initialParameters(layout, random);
  for (const char* name : {"policy", "value"}) {
    const ParameterLayout::Layer layer = layout.layer(name);
    for (Eigen::Index i = 0; i < layer.inputs * layer.outputs; ++i) {
      parameters[layer.kernel + i] = static_cast<float>(random.normal(0.1));
    }
  }
  return parameters;
}

std::vector<planner::Observation> someObservations(const NetworkPlan& plan, std::size_t count) {
  core::RandomStream random(2, "observations");
  planner::ObservationEncoder encoder(plan.max_others, plan.others_order);
  std::vector<planner::Observation> observations;
  for (std::size_t k = 0; k < count; ++k) {
    const planner::Scene scene = planner::randomScene(random, k % 8, 5.0);
    observations.push_back(encoder.encode(scene.ego, scene.others));
  }
  return observations;
}

Batch batchOf(const std::vector<planner::Observation>& observations) {
  Batch batch;
  for (const planner::Observation& each : observations) {
    batch.add(each.ego, each.others);
  }
  return batch;
}

Matrix someHeadGradients(Eigen::Index rows) {
  core::RandomStream random(3, "gradients");
  Matrix d_heads(rows, kHeads);
  for (Eigen::Index i = 0; i < d_heads.size(); ++i) {
    d_heads.data()[i] = static_cast<float>(random.normal(1.0));
  }
  return d_heads;
}

/// An architecture, by hand or by libtorch.
class Network : public testing::TestWithParam<NetworkPlan> {
 protected:
  const NetworkPlan& plan() const { return GetParam(); }

  Parameters gradientOf(TrainableNetwork& network, const Batch& batch,
                        const Matrix& d_heads) const {
    Parameters gradient = Parameters::Zero(parameters_.size());
    network.forward(parameters_, batch);
    network.backward(parameters_, batch, d_heads, gradient);
    return gradient;
  }

  const ParameterLayout layout_ = GetParam().layout();
  const Parameters parameters_ = someParameters(layout_);
};

TEST_P(Network, ForeseesWhatThePlannerFlies) {
  const std::vector<planner::Observation> observations = someObservations(plan(), 40);
  const auto network = makeNetwork(plan());
  const Matrix heads = network->forward(parameters_, batchOf(observations));

  planner::nn::TensorFile file;
  layout_.write(parameters_, "", file);
  file.metadata = planner::ga3cCadrlMetadata({.architecture = plan().architecture,
                                              .normalisation = planner::kPublishedNormalisation,
                                              .max_others = plan().max_others,
                                              .others_order = plan().others_order,
                                              .provenance = "test"});
  planner::Ga3cCadrlNetwork flown(planner::toGa3cCadrlWeights(file, "test"));
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const auto output = flown.evaluate(observations[k]);
    const auto row = heads.row(static_cast<Eigen::Index>(k));
    const Scores probabilities = logProbabilities(row.head<kActionCount>(), 1.0F).exp();
    for (int action = 0; action < kActionCount; ++action) {
      EXPECT_NEAR(probabilities[action], output.probabilities[static_cast<std::size_t>(action)],
                  1e-5);
    }
    EXPECT_NEAR(row[kActionCount], output.value, 1e-5 * (1.0 + std::abs(output.value)));
  }
}

// Along random directions, by differences: small enough that few units cross a kink, large enough
// for single precision.
TEST_P(Network, GradientIsTheSlope) {
  const Batch batch = batchOf(someObservations(plan(), 24));
  const auto network = makeNetwork(plan());
  const Matrix d_heads = someHeadGradients(batch.size());
  const auto sum = [&](const Parameters& at) {
    const Matrix heads = network->forward(at, batch);
    return (heads.cast<double>().array() * d_heads.cast<double>().array()).sum();
  };
  const Parameters gradient = gradientOf(*network, batch, d_heads);
  core::RandomStream random(4, "directions");
  const auto expectSlope = [&](const std::string& name, Eigen::Index begin, Eigen::Index size) {
    Parameters direction = Parameters::Zero(layout_.size());
    for (Eigen::Index i = begin; i < begin + size; ++i) {
      direction[i] = static_cast<float>(random.normal(1.0));
    }
    direction /= direction.norm();
    constexpr float kStep = 4e-4F;
    const double slope =
        (sum(parameters_ + kStep * direction) - sum(parameters_ - kStep * direction)) /
        (2.0 * static_cast<double>(kStep));
    const double expected = gradient.dot(direction);
    EXPECT_NEAR(slope, expected, 0.05 * std::abs(expected) + 0.05) << name;
  };
  for (const auto& [name, layer] : layout_.layers()) {
    expectSlope(name + "/kernel", layer.kernel, layer.inputs * layer.outputs);
    if (layer.bias >= 0) {
      expectSlope(name + "/bias", layer.bias, layer.outputs);
    }
  }
}

TEST_P(Network, GradientIsThatOfTheSamplesOneByOne) {
  const std::vector<planner::Observation> observations = someObservations(plan(), 10);
  const auto network = makeNetwork(plan());
  const Matrix d_heads = someHeadGradients(10);
  const Parameters together = gradientOf(*network, batchOf(observations), d_heads);
  Parameters apart = Parameters::Zero(layout_.size());
  for (std::size_t k = 0; k < observations.size(); ++k) {
    apart +=
        gradientOf(*network, batchOf({observations[k]}), d_heads.row(static_cast<Eigen::Index>(k)));
  }
  EXPECT_LT((together - apart).norm(), 1e-4F * together.norm());
}

TEST_P(Network, TakesNobodyAtAll) {
  const auto network = makeNetwork(plan());
  const Batch batch = batchOf(someObservations(plan(), 10));
  gradientOf(*network, batch, someHeadGradients(10));  // it remembers those
  EXPECT_EQ(network->forward(parameters_, Batch()).rows(), 0);
  Parameters gradient = Parameters::Zero(layout_.size());
  network->backward(parameters_, Batch(), Matrix(0, kHeads), gradient);
  EXPECT_TRUE(gradient.isZero(0.0F));
}

std::string nameOf(const testing::TestParamInfo<NetworkPlan>& info) {
  return info.param.architecture + (info.param.by_torch ? "_by_torch" : "");
}

NetworkPlan planOf(std::string_view architecture, bool by_torch) {
  NetworkPlan plan;
  plan.architecture = architecture;
  plan.max_others = architecture == planner::kWeightSharingArchitecture ? 3 : 19;
  plan.by_torch = by_torch;
  return plan;
}

INSTANTIATE_TEST_SUITE_P(ByHand, Network,
                         testing::Values(planOf(planner::kPooledArchitecture, false),
                                         planOf(planner::kLstmArchitecture, false)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(ByTorch, Network,
                         testing::Values(planOf(planner::kPooledArchitecture, true),
                                         planOf(planner::kLstmArchitecture, true),
                                         planOf(planner::kWeightSharingArchitecture, true),
                                         planOf(planner::kAttentionArchitecture, true)),
                         nameOf);

/// An architecture for which there is a network written by hand.
class HandWrittenNetwork : public Network {};

TEST_P(HandWrittenNetwork, HasLibtorchsGradient) {
  const Batch batch = batchOf(someObservations(plan(), 200));
  const Matrix d_heads = someHeadGradients(batch.size());
  const Parameters by_hand = gradientOf(*makeNetwork(plan()), batch, d_heads);
  NetworkPlan by_torch = plan();
  by_torch.by_torch = true;
  const Parameters by_libtorch = gradientOf(*makeNetwork(by_torch), batch, d_heads);
  for (const auto& [name, layer] : layout_.layers()) {
    const Eigen::Index size = layer.inputs * layer.outputs;
    const auto difference = (by_hand - by_libtorch).segment(layer.kernel, size);
    EXPECT_LT(difference.norm(), 1e-5F * by_libtorch.segment(layer.kernel, size).norm()) << name;
  }
}

TEST(InitialParameters, OfSlotsDoNotDrownTheAgentItself) {
  for (const int slots : {1, 3, 5, 7}) {
    NetworkPlan plan;
    plan.architecture = planner::kWeightSharingArchitecture;
    plan.max_others = slots;
    const ParameterLayout layout = plan.layout();
    core::RandomStream random(1, "parameters");
    const Parameters parameters = initialParameters(layout, random);
    const ParameterLayout::Layer joint = layout.layer("layer1");
    const Eigen::Index own = planner::kEgoInputs * joint.outputs;
    const double of_itself = parameters.segment(joint.kernel, own).squaredNorm();
    const double of_others =
        parameters.segment(joint.kernel + own, joint.inputs * joint.outputs - own).squaredNorm();
    EXPECT_NEAR(of_others / of_itself, 1.44, 0.3) << slots << " slots";

    const ParameterLayout::Layer other = layout.layer("other");
    const Eigen::Map<const Matrix> kernel(parameters.data() + other.kernel, other.inputs,
                                          other.outputs);
    const Eigen::RowVectorXf empty =
        emptySlot() * kernel + parameters.segment(other.bias, other.outputs).transpose();
    EXPECT_LT(empty.maxCoeff(), 0.0F) << "an empty slot says something";
  }
}

INSTANTIATE_TEST_SUITE_P(ByHand, HandWrittenNetwork,
                         testing::Values(planOf(planner::kPooledArchitecture, false),
                                         planOf(planner::kLstmArchitecture, false)),
                         nameOf);

}  // namespace
}  // namespace roundabout::learning
