#include "learning/training/pool_network.h"

#include <cmath>

#include <gtest/gtest.h>

#include "learning/training/scores.h"
#include "planner/policies/ga3c_cadrl/weights.h"
#include "tests/planner/policies/random_scene.h"

namespace roundabout::learning {
namespace {

const ParameterLayout& layout() {
  static const ParameterLayout kLayout(planner::ga3cCadrlTensors(planner::kPooledArchitecture, 19));
  return kLayout;
}

// Heads that differ from each other, unlike those that training begins with.
Parameters someParameters() {
  core::RandomStream random(1, "parameters");
  Parameters parameters = PoolNetwork::initialise(layout(), random);
  for (const char* name : {"policy", "value"}) {
    const ParameterLayout::Layer layer = layout().layer(name);
    for (Eigen::Index i = 0; i < layer.inputs * layer.outputs; ++i) {
      parameters[layer.kernel + i] = static_cast<float>(random.normal(0.1));
    }
  }
  return parameters;
}

std::vector<planner::Observation> someObservations(std::size_t count) {
  core::RandomStream random(2, "observations");
  planner::ObservationEncoder encoder(19, planner::OthersOrder::kClosestLast);
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

TEST(PoolNetwork, ForeseesWhatThePlannerFlies) {
  const Parameters parameters = someParameters();
  const std::vector<planner::Observation> observations = someObservations(40);
  PoolNetwork network(layout());
  const Matrix& heads = network.forward(parameters, batchOf(observations));

  planner::nn::TensorFile file;
  layout().write(parameters, "", file);
  file.metadata = planner::ga3cCadrlMetadata({.architecture = planner::kPooledArchitecture,
                                              .normalisation = planner::kPublishedNormalisation,
                                              .max_others = 19,
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
    EXPECT_NEAR(row[kActionCount], output.value, 1e-4);
  }
}

// Along random directions, by differences: small enough that few units cross a kink, large enough
// for single precision.
TEST(PoolNetwork, GradientIsTheSlope) {
  const Parameters parameters = someParameters();
  const Batch batch = batchOf(someObservations(24));
  PoolNetwork network(layout());
  core::RandomStream random(3, "directions");
  Matrix d_heads(batch.size(), kHeads);
  for (Eigen::Index i = 0; i < d_heads.size(); ++i) {
    d_heads.data()[i] = static_cast<float>(random.normal(1.0));
  }
  const auto sum = [&](const Parameters& at) {
    const Matrix heads = network.forward(at, batch);
    return (heads.cast<double>().array() * d_heads.cast<double>().array()).sum();
  };
  network.forward(parameters, batch);
  Parameters gradient = Parameters::Zero(layout().size());
  network.backward(parameters, batch, d_heads, gradient);
  for (const char* name : {"other1", "other2", "layer1", "layer2", "layer3", "policy", "value"}) {
    const ParameterLayout::Layer layer = layout().layer(name);
    const Eigen::Index kernel_size = layer.inputs * layer.outputs;
    for (const auto& [begin, size] :
         {std::pair(layer.kernel, kernel_size), std::pair(layer.bias, layer.outputs)}) {
      Parameters direction = Parameters::Zero(layout().size());
      for (Eigen::Index i = begin; i < begin + size; ++i) {
        direction[i] = static_cast<float>(random.normal(1.0));
      }
      direction /= direction.norm();
      constexpr float kStep = 4e-4F;
      const double slope =
          (sum(parameters + kStep * direction) - sum(parameters - kStep * direction)) /
          (2.0 * static_cast<double>(kStep));
      const double expected = gradient.dot(direction);
      EXPECT_NEAR(slope, expected, 0.02 * std::abs(expected) + 0.03) << name;
    }
  }
}

TEST(PoolNetwork, GradientIsThatOfTheSamplesOneByOne) {
  const Parameters parameters = someParameters();
  const std::vector<planner::Observation> observations = someObservations(10);
  PoolNetwork network(layout());
  Parameters together = Parameters::Zero(layout().size());
  const Batch batch = batchOf(observations);
  network.forward(parameters, batch);
  network.backward(parameters, batch, Matrix::Ones(batch.size(), kHeads), together);
  Parameters apart = Parameters::Zero(layout().size());
  for (const planner::Observation& each : observations) {
    const Batch single = batchOf({each});
    network.forward(parameters, single);
    network.backward(parameters, single, Matrix::Ones(1, kHeads), apart);
  }
  EXPECT_LT((together - apart).norm(), 1e-4F * together.norm());
}

}  // namespace
}  // namespace roundabout::learning
