#include <limits>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/policies/ga3c_cadrl/weights.h"
#include "tests/support/startup_error.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using ::testing::HasSubstr;

class Ga3cCadrlWeightFile : public ::testing::Test {
 protected:
  std::string error() const {
    return test::startupErrorOf([this] { toGa3cCadrlWeights(file_, "net.safetensors"); });
  }

  std::string errorWith(const std::string& key, const std::string& value) {
    file_ = test::randomGa3cCadrl(1);
    file_.metadata[key] = value;
    return error();
  }

  nn::TensorFile file_ = test::randomGa3cCadrl(1);
};

TEST_F(Ga3cCadrlWeightFile, IsAcceptedAsWritten) { EXPECT_EQ(error(), ""); }

TEST_F(Ga3cCadrlWeightFile, GivesTheNetworkItsStatistics) {
  const auto weights = toGa3cCadrlWeights(file_, "net.safetensors");
  const Normalisation expected = test::unusualNormalisation();
  EXPECT_FLOAT_EQ(weights->ego_deviation[1], static_cast<float>(expected.ego_deviation[1]));
  EXPECT_FLOAT_EQ(weights->other_mean[6], static_cast<float>(expected.other_mean[6]));
  EXPECT_EQ(weights->max_others, 19);
}

TEST_F(Ga3cCadrlWeightFile, SaysInWhichOrderItsNetworkIsFed) {
  for (const NamedOthersOrder& each : kOthersOrders) {
    file_.metadata["others_order"] = each.name;
    EXPECT_EQ(toGa3cCadrlWeights(file_, "net.safetensors")->others_order, each.order);
  }
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithoutOneOfItsTensors) {
  for (const nn::TensorSpec& spec : ga3cCadrlTensors(kLstmArchitecture, 19)) {
    file_ = test::randomGa3cCadrl(1);
    file_.tensors.erase(std::string(spec.name));
    EXPECT_EQ(error(), "net.safetensors: tensor " + std::string(spec.name) + ": expected shape " +
                           nn::shapeText(spec.shape()) + ", found no such tensor");
  }
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithATensorOfAnotherShape) {
  file_.tensors["policy/kernel"] = {{256, 15}, std::vector<float>(256 * 15)};
  EXPECT_EQ(error(),
            "net.safetensors: tensor policy/kernel: expected shape [256, 11], found shape "
            "[256, 15]");
  file_.tensors["policy/kernel"] = {{11, 256}, std::vector<float>(256 * 11)};
  EXPECT_THAT(error(), HasSubstr("found shape [11, 256]"));
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithATensorTooMany) {
  file_.tensors["layer4/kernel"] = {{2}, {0.0F, 0.0F}};
  EXPECT_THAT(error(), HasSubstr("tensor layer4/kernel: expected only tensors of ga3c_cadrl_lstm"));
}

TEST_F(Ga3cCadrlWeightFile, HoldsAsManySlotsAsItSaysWhenWeightsAreShared) {
  // Room for 4, 6 and 8 agents: the ego and so many others.
  for (const int slots : {3, 5, 7}) {
    file_ = test::randomGa3cCadrl(1, kWeightSharingArchitecture, slots);
    const auto weights = toGa3cCadrlWeights(file_, "net.safetensors");
    EXPECT_EQ(weights->max_others, slots);
    EXPECT_EQ(weights->layer1.kernel.rows(), 4 + 64 * slots);
  }
  file_.metadata["max_others"] = "5";
  EXPECT_EQ(error(),
            "net.safetensors: tensor layer1/kernel: expected shape [324, 256], found shape [452, "
            "256]");
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithTheTensorsOfTheOtherArchitecture) {
  file_.metadata["architecture"] = kWeightSharingArchitecture;
  file_.metadata["max_others"] = "1";
  EXPECT_EQ(error(),
            "net.safetensors: tensor other/kernel: expected shape [8, 64], found no such tensor");
  file_ = test::randomGa3cCadrl(1, kWeightSharingArchitecture, 1);
  file_.metadata["architecture"] = kLstmArchitecture;
  EXPECT_EQ(error(),
            "net.safetensors: tensor lstm/kernel: expected shape [71, 256], found no such tensor");
}

TEST_F(Ga3cCadrlWeightFile, NeedsNoWordOnTheValuesBaselineButNoUnknownOne) {
  file_.metadata.erase("value_baseline");
  EXPECT_EQ(toGa3cCadrlWeights(file_, "net.safetensors")->value_baseline, ValueBaseline::kNone);
  file_.metadata["value_baseline"] = "tomorrow";
  EXPECT_EQ(error(),
            "net.safetensors: metadata value_baseline: expected none or lone_agent, found "
            "\"tomorrow\"");
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithANumberThatIsNotFinite) {
  file_.tensors["layer2/kernel"].values[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error(),
            "net.safetensors: tensor layer2/kernel: expected finite numbers, found nan at 5");
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithoutOneOfItsMetadata) {
  const auto complete = file_.metadata;
  for (const auto& [key, value] : complete) {
    if (key == "value_baseline") {
      continue;  // files from before it are read
    }
    file_.metadata = complete;
    file_.metadata.erase(key);
    EXPECT_EQ(error(),
              "net.safetensors: metadata " + key + ": expected to be there, found nothing");
  }
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWhenItIsForAnotherNetwork) {
  EXPECT_EQ(errorWith("architecture", "drl_maca"),
            "net.safetensors: metadata architecture: expected one of ga3c_cadrl_lstm, "
            "ga3c_cadrl_ws, ga3c_cadrl_pool, ga3c_cadrl_attention, found \"drl_maca\"");
  EXPECT_THAT(errorWith("format_version", "2"), HasSubstr("expected \"1\", found \"2\""));
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWhenTheEncoderSeesSomethingElse) {
  EXPECT_THAT(
      errorWith("ego_fields", R"(["distance_to_goal","preferred_speed","heading","radius"])"),
      HasSubstr("metadata ego_fields: expected [\"distance_to_goal\",\"heading\","));
  EXPECT_THAT(errorWith("other_fields", "[]"), HasSubstr("metadata other_fields: expected ["));
  EXPECT_EQ(errorWith("others_order", "closest"),
            "net.safetensors: metadata others_order: expected one of closest_last, closest_first, "
            "time_to_collision, found \"closest\"");
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithOtherActions) {
  const std::string actions = file_.metadata["actions"];
  std::string other_sign = actions;
  other_sign.replace(other_sign.find("-0.52"), 1, "");
  for (const std::string& found : {other_sign, std::string("[[1,0]]"), std::string("11"),
                                   std::string("[1,2,3,4,5,6,7,8,9,10,11]")}) {
    EXPECT_EQ(errorWith("actions", found),
              "net.safetensors: metadata actions: expected " + actions + ", found " + found);
  }
}

TEST_F(Ga3cCadrlWeightFile, IsAcceptedWhenItsAnglesWereRounded) {
  std::string& actions = file_.metadata["actions"];
  const std::string angle = "0.5235987755982988";
  for (std::size_t at = actions.find(angle); at != std::string::npos; at = actions.find(angle)) {
    actions.replace(at, angle.size(), "0.5235988");
  }
  EXPECT_EQ(error(), "");
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithStatisticsThatAreNone) {
  for (const char* found : {"[1,1,1]", "[1,1,1,\"1\"]", "[1,1,1,1e300]", "7", "[1,"}) {
    EXPECT_THAT(errorWith("ego_mean", found), HasSubstr("metadata ego_mean: expected ")) << found;
  }
  EXPECT_EQ(
      errorWith("ego_deviation", "[1,1,0,1]"),
      "net.safetensors: metadata ego_deviation: expected 4 positive numbers, found [1,1,0,1]");
}

TEST_F(Ga3cCadrlWeightFile, IsRefusedWithAnImpossibleNumberOfOthers) {
  for (const char* found : {"0", "-1", "1001", "2.5", "many"}) {
    EXPECT_THAT(errorWith("max_others", found), HasSubstr("metadata max_others: expected "))
        << found;
  }
}

}  // namespace
}  // namespace roundabout::planner
