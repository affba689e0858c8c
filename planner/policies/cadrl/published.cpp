#include "planner/policies/cadrl/published.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "planner/policies/cadrl/weights.h"

namespace roundabout::planner {

namespace {

constexpr int kOwn = CadrlWeights::kOwnInputs;
constexpr int kOther = CadrlWeights::kOtherInputs;
constexpr int kUnits = CadrlWeights::kUnits;
constexpr int kInputs = kOwn + kCadrlOthers * kOther;
constexpr int kWidth = (1 + kCadrlOthers) * kUnits;

constexpr std::array<nn::TensorSpec, 12> kPublished = {{{"W0", kInputs, kWidth},
                                                        {"b0", 1, kWidth},
                                                        {"W1", kWidth, kWidth},
                                                        {"b1", 1, kWidth},
                                                        {"W3", 2 * kUnits, kUnits},
                                                        {"b3", 1, kUnits},
                                                        {"W4", kUnits, 1},
                                                        {"b4", 1, 1},
                                                        {"input_avg", 0, kInputs},
                                                        {"input_std", 0, kInputs},
                                                        {"output_avg", 0, 1},
                                                        {"output_std", 0, 1}}};

/// Takes a published matrix apart into the blocks that are the same for every other agent.
class Blocks {
 public:
  /// own, other: sizes of the blocks of rows.
  Blocks(const nn::WeightFile& file, const std::string& path, const std::string& name, int own,
         int other)
      : whole_(file.matrix(name)), path_(path), name_(name), own_(own), other_(other) {}

  nn::Matrix ownFromOwn() const { return block(-1, -1); }
  nn::Matrix ownFromOther() const {
    return same(kCadrlOthers, [this](int k) { return block(k, -1); });
  }
  nn::Matrix otherFromOwn() const {
    return same(kCadrlOthers, [this](int k) { return block(-1, k); });
  }
  nn::Matrix otherFromSelf() const {
    return same(kCadrlOthers, [this](int k) { return block(k, k); });
  }
  nn::Matrix otherFromOther() const {
    return same(kCadrlOthers * (kCadrlOthers - 1), [this](int pair) {
      const int from = pair % kCadrlOthers;
      return block(from, (from + 1 + pair / kCadrlOthers) % kCadrlOthers);
    });
  }

 private:
  /// -1: the ego's.
  nn::Matrix block(int from, int to) const {
    return from < 0 ? whole_.block(0, (1 + to) * kUnits, own_, kUnits)
                    : whole_.block(own_ + from * other_, (1 + to) * kUnits, other_, kUnits);
  }

  template <class BlockOf>
  nn::Matrix same(int count, BlockOf block_of) const {
    const nn::Matrix first = block_of(0);
    for (int i = 1; i < count; ++i) {
      if (block_of(i) != first) {
        throw core::StartupError(path_, "tensor " + name_, "the same weights for every other agent",
                                 "different ones");
      }
    }
    return first;
  }

  Eigen::Map<const nn::Matrix> whole_;
  const std::string& path_;
  std::string name_;
  int own_;
  int other_;
};

class Import {
 public:
  Import(const nn::TensorFile& published, const std::string& path)
      : published_(published, path), path_(path) {
    published_.requireTensors(kPublished, "the published network");
  }

  nn::TensorFile run() {
    addShared("layer1", "W0", "b0", kOwn, kOther);
    addShared("layer2", "W1", "b1", kUnits, kUnits);
    add("layer3/kernel", published_.matrix("W3"));
    addVector("layer3/bias", published_.matrix("b3"));
    add("value/kernel", published_.matrix("W4"));
    addVector("value/bias", published_.matrix("b4"));
    file_.metadata = cadrlMetadata(
        normalisation(), "imported from " + std::filesystem::path(path_).filename().string());
    return std::move(file_);
  }

 private:
  void add(const std::string& name, const nn::Matrix& matrix) {
    file_.tensors[name] = {{matrix.rows(), matrix.cols()},
                           {matrix.data(), matrix.data() + matrix.size()}};
  }

  void addVector(const std::string& name, const nn::Matrix& row) {
    file_.tensors[name] = {{row.cols()}, {row.data(), row.data() + row.size()}};
  }

  void addShared(const std::string& layer, const std::string& kernel, const std::string& bias,
                 int own, int other) {
    const Blocks blocks(published_, path_, kernel, own, other);
    add(layer + "/own_from_own", blocks.ownFromOwn());
    add(layer + "/own_from_other", blocks.ownFromOther());
    add(layer + "/other_from_own", blocks.otherFromOwn());
    add(layer + "/other_from_self", blocks.otherFromSelf());
    add(layer + "/other_from_other", blocks.otherFromOther());
    const Blocks biases(published_, path_, bias, 1, 0);
    addVector(layer + "/own_bias", biases.ownFromOwn());
    addVector(layer + "/other_bias", biases.otherFromOwn());
  }

  CadrlNormalisation normalisation() const {
    CadrlNormalisation result;
    split("input_avg", result.own_mean, result.other_mean);
    split("input_std", result.own_deviation, result.other_deviation);
    result.value_mean = published_.matrix("output_avg")(0);
    result.value_deviation = published_.matrix("output_std")(0);
    return result;
  }

  template <class Own, class Other>
  void split(const std::string& name, Own& own, Other& other) const {
    const float* const numbers = published_.matrix(name).data();
    std::copy_n(numbers, kOwn, own.begin());
    std::copy_n(numbers + kOwn, kOther, other.begin());
    for (int k = 1; k < kCadrlOthers; ++k) {
      if (!std::equal(other.begin(), other.end(), numbers + kOwn + k * kOther)) {
        throw core::StartupError(path_, "tensor " + name, "the same numbers for every other agent",
                                 "different ones");
      }
    }
  }

  nn::WeightFile published_;
  const std::string& path_;
  nn::TensorFile file_;
};

}  // namespace

bool isPublishedCadrl(const nn::TensorFile& file) {
  return !file.metadata.contains("architecture") && file.tensors.contains("W0");
}

nn::TensorFile importPublishedCadrl(const nn::TensorFile& published, const std::string& path) {
  return Import(published, path).run();
}

}  // namespace roundabout::planner
