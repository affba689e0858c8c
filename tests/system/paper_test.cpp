// The paper's multirotor experiments with the policies there are, from the experiment files that
// are shipped.

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/reference.h"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

class Paper : public FlightLab {
 protected:
  std::string experiment(const std::string& name) const {
    return std::string(ROUNDABOUT_SOURCE_DIR) + "/experiments/" + name + ".yaml";
  }

  nlohmann::json fly(const std::string& name, std::vector<std::string> arguments = {}) {
    const Ended ended = finish(startFlight(experiment(name), std::move(arguments)));
    EXPECT_TRUE(ended.status.clean()) << ended.status.describe();
    std::ifstream file(out() / "metrics.json");
    return nlohmann::json::parse(file);
  }

  void expectSwapped(const nlohmann::json& metrics) {
    EXPECT_EQ(metrics["formations_formed"], 1);
    EXPECT_EQ(metrics["separation"]["body_touches"]["count"], 0);
    EXPECT_GT(metrics["separation"]["closest_body_gap"]["gap_m"], 0.0);
  }

  // --policy for the published network, imported from its checkpoint.
  std::vector<std::string> publishedNetwork() {
    const std::string weights = (scratch_ / "published.safetensors").string();
    EXPECT_TRUE(run("roundabout", {"policy", "import",
                                   (referenceFolder() / "ga3c_cadrl" / "checkpoints" /
                                    "gym_IROS18_01900000" / "network_01900000")
                                       .string(),
                                   "-o", weights})
                    .status.clean());
    return {"--policy", "ga3c_cadrl:" + weights};
  }
};

TEST_F(Paper, ParallelPairsSwapWithOrca) { expectSwapped(fly("parallel_swap")); }

TEST_F(Paper, OrthogonalPairsSwapWithOrca) { expectSwapped(fly("orthogonal_swap")); }

TEST_F(Paper, ParallelPairsSwapWithThePublishedNetwork) {
  if (!std::filesystem::exists(referenceFolder() / "ga3c_cadrl")) {
    GTEST_SKIP() << "the published network is not at " << referenceFolder();
  }
  expectSwapped(fly("parallel_swap", publishedNetwork()));
}

TEST_F(Paper, OrthogonalPairsSwapWithThePublishedNetwork) {
  if (!std::filesystem::exists(referenceFolder() / "ga3c_cadrl")) {
    GTEST_SKIP() << "the published network is not at " << referenceFolder();
  }
  expectSwapped(fly("orthogonal_swap", publishedNetwork()));
}

TEST_F(Paper, SixVehiclesSpellCadrl) {
  const nlohmann::json metrics = fly("spell_cadrl");
  std::vector<std::string> letters;
  for (const auto& formation : metrics["formations"]) {
    EXPECT_TRUE(formation["formed"]) << formation["name"];
    letters.push_back(formation["name"]);
  }
  EXPECT_EQ(letters, (std::vector<std::string>{"C", "A", "D", "R", "L"}));
  EXPECT_EQ(metrics["separation"]["body_touches"]["count"], 0);
}

}  // namespace
}  // namespace roundabout::test
