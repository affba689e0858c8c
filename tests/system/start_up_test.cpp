// Wrong input at the start: one line that names file, key, what was expected and what was found.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/weights.h"
#include "tests/system/flight_lab.h"

namespace roundabout::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class StartUp : public FlightLab {
 protected:
  // Flies the file; the last thing said must be one line with these words, and nothing may be left
  // running.
  void expectRefusal(const std::string& file, const std::vector<std::string>& words,
                     const std::vector<std::string>& arguments = {}) {
    const Ended flight = finish(startFlight(file, arguments));
    EXPECT_EQ(flight.status.code, 2) << flight.status.describe();
    ASSERT_FALSE(flight.lines.empty());
    for (const std::string& word : words) {
      EXPECT_THAT(flight.lines.back(), HasSubstr(word));
    }
    EXPECT_THAT(flight.lines.back(), AllOf(HasSubstr("expected"), HasSubstr("found")));
    EXPECT_LE(flight.lines.size(), 2U) << "more than what flies and what is wrong";
    EXPECT_THAT(leftRunning(), IsEmpty());
  }
};

TEST_F(StartUp, RefusesAMisspeltKeyAndNamesTheRightOne) {
  expectRefusal(twoSwap("saftey: {states_hold_s: 0.2}\n"),
                {"two_swap.yaml:12", "saftey", "safety"});
}

TEST_F(StartUp, RefusesAValueOfTheWrongType) {
  expectRefusal(twoSwap("sim: {max_duration_s: soon}\n"),
                {"two_swap.yaml:12", "sim.max_duration_s", "number", "soon"});
}

TEST_F(StartUp, RefusesASourceThatIsNotThereYet) {
  expectRefusal(twoSwap("source: vicon\n"), {"two_swap.yaml:12", "source", "sim", "vicon"});
}

TEST_F(StartUp, RefusesAMissingFile) {
  expectRefusal((scratch_ / "absent.yaml").string(), {"absent.yaml", "No such file"});
}

TEST_F(StartUp, RefusesAnOverrideOfNoKey) {
  expectRefusal(twoSwap(), {"--set", "sim.pase"}, {"--set", "sim.pase=1"});
}

TEST_F(StartUp, RefusesTwoVehiclesOfOneName) {
  expectRefusal(write("twins.yaml", "name: twins\nvehicles: [{name: hex1}, {name: hex1}]\n"),
                {"twins.yaml", "vehicles[1].name", "hex1"});
}

TEST_F(StartUp, RefusesGoalsThatAreTooClose) {
  expectRefusal(
      write("close.yaml",
            "name: close\nvehicles: [{name: hex1}, {name: hex2}]\n"
            "mission: [take_off, {formation: {name: near, points: [[0, 0], [0.5, 0]]}}]\n"),
      {"close.yaml", "mission[1].formation", "0.50 m apart"});
}

TEST_F(StartUp, RefusesAFormationWithMorePointsThanVehicles) {
  expectRefusal(write("crowd.yaml",
                      "name: crowd\nvehicles: [{name: hex1}]\n"
                      "mission: [take_off, {formation: {name: pair, points: [[0, 0], [3, 0]]}}]\n"),
                {"crowd.yaml:3", "mission[1].formation.points", "found 2"});
}

TEST_F(StartUp, RefusesAnUnknownPolicy) {
  expectRefusal(twoSwap(), {"planner.policy", "orca", "orka"}, {"--policy", "orka"});
}

TEST_F(StartUp, RefusesWeightsThatAreMissing) {
  expectRefusal(twoSwap(), {"absent.safetensors", "No such file"},
                {"--policy", "ga3c_cadrl:" + (scratch_ / "absent.safetensors").string()});
}

TEST_F(StartUp, RefusesTruncatedWeights) {
  const std::filesystem::path file = scratch_ / "short.safetensors";
  writeRandomGa3cCadrl(file.string());
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  expectRefusal(twoSwap(), {"short.safetensors"}, {"--policy", "ga3c_cadrl:" + file.string()});
}

TEST_F(StartUp, RefusesWeightsOfTheWrongShape) {
  planner::nn::TensorFile weights = randomGa3cCadrl(1);
  weights.tensors["policy/kernel"] = {{256, 15}, std::vector<float>(256 * 15)};
  const std::string file = (scratch_ / "wide.safetensors").string();
  planner::nn::writeSafetensors(file, weights);
  expectRefusal(twoSwap(), {"wide.safetensors", "policy/kernel", "[256, 11]", "[256, 15]"},
                {"--policy", "ga3c_cadrl:" + file});
}

TEST_F(StartUp, RefusesAUrlThatIsNone) {
  const Ended flight = run("roundabout", {"fly", twoSwap(), "--lcm-url", "tcp://here"});
  EXPECT_EQ(flight.status.code, 2);
  EXPECT_THAT(flight.lines.back(), AllOf(HasSubstr("lcm_url"), HasSubstr("tcp://here")));
}

TEST_F(StartUp, RefusesAMachineWithoutAMulticastRoute) {
  // A network namespace of its own has no route at all; making one needs the right to.
  if (run("unshare", {"-n", "true"}).status.code != 0) {
    GTEST_SKIP() << "no right to make a network namespace";
  }
  const Ended flight = run("unshare", {"-n", std::string(ROUNDABOUT_BIN_DIR) + "/roundabout", "fly",
                                       twoSwap(), "--lcm-url", url(), "--out", out().string()});
  EXPECT_EQ(flight.status.code, 2);
  ASSERT_EQ(flight.lines.size(), 1U);
  EXPECT_THAT(flight.lines[0], AllOf(HasSubstr(url()), HasSubstr("expected a multicast route"),
                                     HasSubstr("unreachable")));
}

}  // namespace
}  // namespace roundabout::test
