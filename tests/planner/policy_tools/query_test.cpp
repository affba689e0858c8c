#include "planner/policy_tools/query.h"

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planner/policies/ga3c_cadrl/weights.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kAlone =
    R"({"num_other_agents": 0, "ego": [5.0, 0.1, 1.0, 0.5], "others": []})";
constexpr const char* kWithOne =
    R"({"id": "x", "num_other_agents": 1, "ego": [5.0, 0.1, 1.0, 0.5], )"
    R"("others": [[2.0, 1.0, -0.5, 0.25, 0.5, 1.0, 1.2]]})";

class PolicyQuery : public ::testing::Test {
 protected:
  PolicyQuery() { test::writeRandomGa3cCadrl(weights_, 1); }

  void query(const std::string& lines) {
    std::istringstream in(lines);
    std::ostringstream out;
    std::ostringstream errors;
    bad_lines_ = queryPolicy(weights_, in, out, errors);
    out_ = out.str();
    errors_ = errors.str();
  }

  test::ScratchFolder folder_;
  std::string weights_ = folder_ / "weights.safetensors";
  int bad_lines_ = 0;
  std::string out_;
  std::string errors_;
};

TEST_F(PolicyQuery, WritesEachLineBackWithItsResult) {
  query(std::string(kAlone) + "\n" + kWithOne + "\n");
  EXPECT_EQ(bad_lines_, 0);
  EXPECT_EQ(errors_, "");
  std::istringstream lines(out_);
  std::string first;
  std::string second;
  std::getline(lines, first);
  std::getline(lines, second);
  EXPECT_THAT(first, StartsWith(R"({"num_other_agents":0,"ego":[5.0,0.1,1.0,0.5],"others":[],)"));

  const auto record = nlohmann::json::parse(second);
  EXPECT_EQ(record.at("id"), "x");
  Ga3cCadrlNetwork network(readGa3cCadrlWeights(weights_));
  Observation observation;
  observation.ego = {5.0F, 0.1F, 1.0F, 0.5F};
  observation.others = {{2.0F, 1.0F, -0.5F, 0.25F, 0.5F, 1.0F, 1.2F}};
  const auto output = network.evaluate(observation);
  EXPECT_EQ(record.at("value").get<float>(), output.value);
  EXPECT_EQ(record.at("action"), output.best_action);
  EXPECT_EQ(record.at("probs").get<std::vector<float>>(),
            std::vector<float>(output.probabilities.begin(), output.probabilities.end()));
}

TEST_F(PolicyQuery, NamesABadLineAndGoesOn) {
  query(std::string(kAlone) + "\nnonsense\n" + kAlone + "\n");
  EXPECT_EQ(bad_lines_, 1);
  EXPECT_EQ(errors_, "line 2: observation: expected a JSON object, found no JSON\n");
  EXPECT_EQ(std::count(out_.begin(), out_.end(), '\n'), 2);
}

TEST_F(PolicyQuery, SaysWhatIsWrongWithALine) {
  struct Case {
    const char* line;
    const char* error;
  };
  for (const Case& each : {
           Case{"[]", "line 1: observation: expected a JSON object, found array"},
           Case{"", "line 1: observation: expected a JSON object, found no JSON"},
           Case{R"({"num_other_agents":0,"others":[]})",
                "ego: expected to be there, found nothing"},
           Case{R"({"num_other_agents":0,"ego":[1,2,3],"others":[]})",
                "ego: expected a list of 4 numbers, found a list of 3"},
           Case{R"({"num_other_agents":0,"ego":[1,2,3,"4"],"others":[]})",
                "ego: expected a list of 4 numbers, found [1,2,3,\"4\"]"},
           Case{R"({"num_other_agents":0,"ego":[1,2,3,1e39],"others":[]})",
                "ego: expected a list of 4 numbers, found [1,2,3,1e+39]"},
           Case{R"({"num_other_agents":0,"ego":[1,2,3,4]})",
                "others: expected to be there, found nothing"},
           Case{R"({"num_other_agents":0,"ego":[1,2,3,4],"others":7})",
                "others: expected a list of at most 19, found 7"},
           Case{R"({"num_other_agents":1,"ego":[1,2,3,4],"others":[[1,2,3]]})",
                "others[0]: expected a list of 7 numbers, found a list of 3"},
           Case{R"({"num_other_agents":2,"ego":[1,2,3,4],"others":[]})",
                "num_other_agents: expected 0, as in others, found 2"},
       }) {
    query(each.line + std::string("\n"));
    EXPECT_EQ(bad_lines_, 1) << each.line;
    EXPECT_THAT(errors_, HasSubstr(each.error)) << each.line;
  }
}

TEST_F(PolicyQuery, RefusesMoreOthersThanTheNetworkReads) {
  nlohmann::json record = nlohmann::json::parse(kWithOne);
  record["others"] = std::vector<nlohmann::json>(20, record["others"][0]);
  record["num_other_agents"] = 20;
  query(record.dump() + "\n");
  EXPECT_EQ(errors_, "line 1: others: expected a list of at most 19, found a list of 20\n");
}

}  // namespace
}  // namespace roundabout::planner
