#include "tests/support/cadrl_weights.h"

#include <string>
#include <vector>

#include "planner/policies/cadrl/weights.h"
#include "tests/support/random_tensors.h"

namespace roundabout::test {

namespace {

using planner::kCadrlOthers;
using planner::nn::Matrix;
using planner::nn::TensorFile;

constexpr planner::CadrlNormalisation kNormalisation = {
    .own_mean = {6.0F, 0.7F, 0.6F, 0.1F, 0.5F, -0.1F, 0.4F},
    .own_deviation = {4.0F, 0.5F, 0.3F, 0.8F, 0.6F, 0.4F, 0.3F},
    .other_mean = {0.1F, -0.1F, 0.2F, -0.2F, 0.3F, 0.6F, 3.0F, 0.6F},
    .other_deviation = {0.7F, 0.9F, 3.0F, 5.0F, 0.3F, 0.5F, 3.0F, 0.4F},
    .value_mean = 0.3F,
    .value_deviation = 0.2F,
};

Matrix matrixOf(const TensorFile& file, const std::string& name) {
  static const std::string path;
  return planner::nn::WeightFile(file, path).matrix(name);
}

planner::nn::Tensor tensorOf(const Matrix& matrix) {
  return {{matrix.rows(), matrix.cols()}, {matrix.data(), matrix.data() + matrix.size()}};
}

/// The blocks of one layer in one matrix, once for every other agent.
Matrix whole(const TensorFile& file, const std::string& layer) {
  const auto part = [&](const char* name) { return matrixOf(file, layer + "/" + name); };
  const Matrix own = part("own_from_own");
  const Matrix other = part("own_from_other");
  const Eigen::Index units = own.cols();
  Matrix result(own.rows() + kCadrlOthers * other.rows(), (1 + kCadrlOthers) * units);
  result.topLeftCorner(own.rows(), units) = own;
  for (int k = 0; k < kCadrlOthers; ++k) {
    const Eigen::Index row = own.rows() + k * other.rows();
    result.block(0, (1 + k) * units, own.rows(), units) = part("other_from_own");
    result.block(row, 0, other.rows(), units) = other;
    for (int j = 0; j < kCadrlOthers; ++j) {
      result.block(row, (1 + j) * units, other.rows(), units) =
          part(j == k ? "other_from_self" : "other_from_other");
    }
  }
  return result;
}

Matrix wholeBias(const TensorFile& file, const std::string& layer) {
  const Matrix other = matrixOf(file, layer + "/other_bias");
  Matrix result(1, (1 + kCadrlOthers) * other.cols());
  result << matrixOf(file, layer + "/own_bias"), other.replicate(1, kCadrlOthers);
  return result;
}

template <class Own, class Other>
planner::nn::Tensor statistics(const Own& own, const Other& other) {
  std::vector<float> numbers(own.begin(), own.end());
  for (int k = 0; k < kCadrlOthers; ++k) {
    numbers.insert(numbers.end(), other.begin(), other.end());
  }
  return {{static_cast<std::int64_t>(numbers.size())}, numbers};
}

}  // namespace

TensorFile randomCadrl(std::uint64_t seed) {
  TensorFile file = randomTensors(planner::kCadrlTensors, seed);
  file.metadata = planner::cadrlMetadata(kNormalisation, "random, for tests");
  return file;
}

TensorFile randomPublishedCadrl(std::uint64_t seed) {
  const TensorFile ours = randomCadrl(seed);
  TensorFile file;
  file.tensors["W0"] = tensorOf(whole(ours, "layer1"));
  file.tensors["b0"] = tensorOf(wholeBias(ours, "layer1"));
  file.tensors["W1"] = tensorOf(whole(ours, "layer2"));
  file.tensors["b1"] = tensorOf(wholeBias(ours, "layer2"));
  file.tensors["W3"] = tensorOf(matrixOf(ours, "layer3/kernel"));
  file.tensors["b3"] = tensorOf(matrixOf(ours, "layer3/bias"));
  file.tensors["W4"] = tensorOf(matrixOf(ours, "value/kernel"));
  file.tensors["b4"] = tensorOf(matrixOf(ours, "value/bias"));
  file.tensors["input_avg"] = statistics(kNormalisation.own_mean, kNormalisation.other_mean);
  file.tensors["input_std"] =
      statistics(kNormalisation.own_deviation, kNormalisation.other_deviation);
  file.tensors["output_avg"] = {{1}, {kNormalisation.value_mean}};
  file.tensors["output_std"] = {{1}, {kNormalisation.value_deviation}};
  return file;
}

}  // namespace roundabout::test
