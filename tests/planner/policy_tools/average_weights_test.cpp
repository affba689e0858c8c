#include "planner/policy_tools/average_weights.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using ::testing::HasSubstr;

class AverageWeights : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const nn::TensorFile& file) {
    nn::writeSafetensors(folder_.file(name), file);
    return folder_.file(name);
  }
  /// A later state of the first network's training.
  nn::TensorFile later(float change) const {
    nn::TensorFile file = first_;
    for (auto& [name, tensor] : file.tensors) {
      for (std::size_t i = 0; i < tensor.values.size(); ++i) {
        tensor.values[i] *= 1.0F + (i % 3 == 0 ? change : -change);
      }
    }
    return file;
  }
  std::string refusalOf(const nn::TensorFile& second) {
    const std::string first = write("first.safetensors", first_);
    const std::string other = write("second.safetensors", second);
    return test::startupErrorOf([&] { averageWeights({first, other}); });
  }

  test::ScratchFolder folder_;
  nn::TensorFile first_ = test::randomGa3cCadrl(1);
};

TEST_F(AverageWeights, IsTheMeanOfEveryNumber) {
  const nn::TensorFile second = later(0.1F);
  nn::TensorFile third = later(0.3F);
  third.metadata["recipe"] = "of the third";
  third.metadata["provenance"] = "third";
  third.metadata["validation"] = "of the third alone";
  const nn::TensorFile mean =
      averageWeights({write("1.safetensors", first_), write("2.safetensors", second),
                      write("3.safetensors", third)});
  ASSERT_EQ(mean.tensors.size(), first_.tensors.size());
  for (const auto& [name, tensor] : mean.tensors) {
    ASSERT_EQ(tensor.shape, first_.tensors.at(name).shape);
    for (std::size_t i = 0; i < tensor.values.size(); ++i) {
      const float sum = first_.tensors.at(name).values[i] + second.tensors.at(name).values[i] +
                        third.tensors.at(name).values[i];
      ASSERT_NEAR(tensor.values[i], sum / 3.0F, 1e-6F) << name;
    }
  }
  EXPECT_THAT(mean.metadata.at("provenance"), HasSubstr("mean of 3 networks: "));
  EXPECT_THAT(mean.metadata.at("provenance"), HasSubstr("; third"));
  EXPECT_EQ(mean.metadata.at("recipe"), "of the third");
  EXPECT_FALSE(mean.metadata.contains("validation"));
  EXPECT_EQ(mean.metadata.at("architecture"), first_.metadata.at("architecture"));
}

TEST_F(AverageWeights, RefusesNetworksThatMeanSomethingElse) {
  nn::TensorFile other = test::randomGa3cCadrl(2);
  other.metadata["others_order"] = "closest_first";
  EXPECT_THAT(refusalOf(other), HasSubstr("second.safetensors: others_order: expected"));
  other = test::randomGa3cCadrl(2);
  other.metadata["more"] = "than the first";
  EXPECT_THAT(refusalOf(other), HasSubstr("second.safetensors: more: expected none"));
}

TEST_F(AverageWeights, RefusesOtherTensors) {
  nn::TensorFile other = test::randomGa3cCadrl(2);
  const std::string name = other.tensors.begin()->first;
  other.tensors.erase(name);
  EXPECT_THAT(refusalOf(other), HasSubstr("second.safetensors: " + name));
  other = test::randomGa3cCadrl(2);
  other.tensors["another/kernel"] = {{1}, {0.0F}};
  EXPECT_THAT(refusalOf(other), HasSubstr("another/kernel: expected no such tensor"));
}

TEST_F(AverageWeights, RefusesANetworkOfAnotherTraining) {
  EXPECT_THAT(
      refusalOf(test::randomGa3cCadrl(2)),
      ::testing::AllOf(HasSubstr("second.safetensors: weights: expected those of another state "
                                 "of the training of "),
                       HasSubstr("first.safetensors, found a network of its own (cosine ")));
  nn::TensorFile broken = first_;
  broken.tensors.begin()->second.values[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusalOf(broken), HasSubstr("second.safetensors"));
}

TEST_F(AverageWeights, RefusesOneAlone) {
  EXPECT_THAT(test::startupErrorOf([this] { averageWeights({write("1.safetensors", first_)}); }),
              HasSubstr("expected two or more, found 1"));
}

}  // namespace
}  // namespace roundabout::planner
