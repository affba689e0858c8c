#include "planner/policies/table.h"

#include <gtest/gtest.h>

#include "tests/support/startup_error.h"

namespace roundabout::planner {
namespace {

std::string errorOf(const std::string& specification) {
  PolicyOptions options;
  options.where = "demo.yaml";
  return test::startupErrorOf([&] { makePolicy(specification, options); });
}

TEST(PolicyTable, NamesAreDistinct) {
  for (const PolicyEntry& a : policyTable()) {
    for (const PolicyEntry& b : policyTable()) {
      EXPECT_TRUE(&a == &b || a.name != b.name) << a.name;
    }
  }
}

TEST(PolicyTable, MisspeltNameIsAnsweredWithAllNamesAndTheNearest) {
  EXPECT_EQ(errorOf("orka"),
            "demo.yaml: planner.policy: expected one of ga3c_cadrl, cadrl, drl_maca, orca, "
            "non_cooperative, "
            "static, "
            "found \"orka\" (did you mean \"orca\"?)");
}

TEST(PolicyTable, NameLikeNoneIsAnsweredWithAllNames) {
  EXPECT_EQ(errorOf("zzz"),
            "demo.yaml: planner.policy: expected one of ga3c_cadrl, cadrl, drl_maca, orca, "
            "non_cooperative, "
            "static, "
            "found \"zzz\"");
}

TEST(PolicyTable, MissingWeightsAreAskedFor) {
  EXPECT_EQ(errorOf("cadrl"),
            "demo.yaml: planner.policy: expected \"cadrl:WEIGHTS\", found \"cadrl\"");
  EXPECT_EQ(errorOf("ga3c_cadrl:"),
            "demo.yaml: planner.policy: expected \"ga3c_cadrl:WEIGHTS\", found \"ga3c_cadrl:\"");
}

TEST(PolicyTable, WeightsThatShipAreThereAndMeantWithoutAWord) {
  for (const PolicyEntry& entry : policyTable()) {
    const std::string name(entry.name);
    EXPECT_EQ(weightsOf(name), entry.shipped_weights);
    if (!entry.shipped_weights.empty()) {
      EXPECT_EQ(errorOf(name), "");
    }
  }
  EXPECT_EQ(weightsOf("ga3c_cadrl:a.safetensors"), "a.safetensors");
  EXPECT_EQ(weightsOf("orca"), "");
  EXPECT_EQ(weightsOf("nobody"), "");
}

TEST(PolicyTable, SuperfluousWeightsAreRefused) {
  EXPECT_EQ(errorOf("orca:a.safetensors"),
            "demo.yaml: planner.policy: expected \"orca\", which has no weights, found "
            "\"orca:a.safetensors\"");
  EXPECT_EQ(errorOf("orca:"),
            "demo.yaml: planner.policy: expected \"orca\", which has no weights, found \"orca:\"");
}

TEST(PolicyTable, MissingWeightFileIsNamed) {
  EXPECT_NE(errorOf("ga3c_cadrl:/no/such.safetensors").find("/no/such.safetensors"),
            std::string::npos);
}

TEST(PolicyTable, WeightsMayContainColons) {
  EXPECT_NE(errorOf("ga3c_cadrl:/no/a:b.safetensors").find("/no/a:b.safetensors"),
            std::string::npos);
}

}  // namespace
}  // namespace roundabout::planner
