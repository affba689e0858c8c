#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/policies/ga3c_cadrl/weights.h"
#include "planner/policy_tools/gates/analysis.h"
#include "planner/policy_tools/gates/figure.h"
#include "planner/policy_tools/import_checkpoint.h"
#include "tests/support/reference.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/startup_error.h"
#include "tests/support/weights.h"

namespace roundabout::planner {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kScenes =
    std::filesystem::path(ROUNDABOUT_SOURCE_DIR) / "experiments/gates";

GateAnalysis analyse(const nn::TensorFile& file, const std::string& scene) {
  return analyseGates(*toGa3cCadrlWeights(file, "net"), "net",
                      readGateScene((kScenes / (scene + ".yaml")).string()));
}

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

// What a file's tensors make of one more agent, with plain loops.
class PlainLstm {
 public:
  explicit PlainLstm(const nn::TensorFile& file)
      : kernel_(file.tensors.at("lstm/kernel").values),
        bias_(file.tensors.at("lstm/bias").values) {}

  // Before sigmoid or tanh, of one block of columns.
  double sum(const OtherInput& input, bool state, bool hidden, bool bias, int block,
             int unit) const {
    const std::size_t column = static_cast<std::size_t>(64 * block + unit);
    double result = bias ? double{bias_[column]} : 0.0;
    for (std::size_t row = 0; row < 71; ++row) {
      const bool of_state = row < 7;
      if (of_state ? state : hidden) {
        const double value =
            of_state ? double{input[static_cast<Eigen::Index>(row)]} : hidden_[row - 7];
        result += value * double{kernel_[row * 256 + column]};
      }
    }
    return result;
  }

  // Distance of the gate from what it is without one of its inputs.
  double effect(const OtherInput& input, bool state, bool hidden, bool bias) const {
    double squares = 0.0;
    for (int unit = 0; unit < 64; ++unit) {
      const double change = sigmoid(sum(input, true, true, true, 0, unit)) -
                            sigmoid(sum(input, state, hidden, bias, 0, unit));
      squares += change * change;
    }
    return std::sqrt(squares);
  }

  double mean(const OtherInput& input) const {
    double total = 0.0;
    for (int unit = 0; unit < 64; ++unit) {
      total += sigmoid(sum(input, true, true, true, 0, unit));
    }
    return total / 64.0;
  }

  void read(const OtherInput& input) {
    std::vector<double> next(64);
    for (int unit = 0; unit < 64; ++unit) {
      const auto gate = [&](int block) { return sum(input, true, true, true, block, unit); };
      const std::size_t u = static_cast<std::size_t>(unit);
      cell_[u] = sigmoid(gate(2) + 1.0) * cell_[u] + sigmoid(gate(0)) * std::tanh(gate(1));
      next[u] = sigmoid(gate(3)) * std::tanh(cell_[u]);
    }
    hidden_ = next;
  }

 private:
  std::vector<float> kernel_;
  std::vector<float> bias_;
  std::vector<double> hidden_ = std::vector<double>(64, 0.0);
  std::vector<double> cell_ = std::vector<double>(64, 0.0);
};

TEST(GateDynamics, AreThePapersEquations) {
  const nn::TensorFile file = test::randomGa3cCadrl(1);
  const auto weights = toGa3cCadrlWeights(file, "net");
  const GateAnalysis analysis = analyse(file, "approaching");
  ASSERT_EQ(analysis.steps.size(), 6U);
  PlainLstm plain(file);
  for (std::size_t i = 0; i < 6; ++i) {
    SCOPED_TRACE(i);
    const OtherInput input = weights->normalisedOther(analysis.observation.others[i]);
    const double state = plain.effect(input, false, true, true);
    const double hidden = plain.effect(input, true, false, true);
    const double bias = plain.effect(input, true, true, false);
    const double scale = plain.mean(input) / (state + hidden + bias);
    const GateStep& step = analysis.steps[i];
    EXPECT_NEAR(step.mean, plain.mean(input), 1e-5);
    EXPECT_NEAR(step.state_part, scale * state, 1e-5);
    EXPECT_NEAR(step.hidden_part, scale * hidden, 1e-5);
    EXPECT_NEAR(step.bias_part, scale * bias, 1e-5);
    plain.read(input);
  }
}

TEST(GateDynamics, OweNothingToAHiddenStateThatIsStillEmpty) {
  EXPECT_EQ(analyse(test::randomGa3cCadrl(2), "leaving").steps[0].hidden_part, 0.0);
}

TEST(GateDynamics, NeedAnLstm) {
  EXPECT_EQ(test::startupErrorOf([] {
              analyse(test::randomGa3cCadrl(3, kWeightSharingArchitecture, 7), "leaving");
            }),
            "net: metadata architecture: expected a network with an LSTM, found one whose other "
            "agents share weights");
}

// The paper's finding: what the closest agent adds grows when it approaches, and does not when it
// leaves.
TEST(GateDynamics, OfThePublishedNetworkAreWhatThePaperFound) {
  const std::string prefix =
      test::referenceFolder() / "ga3c_cadrl/checkpoints/gym_IROS18_01900000/network_01900000";
  if (!std::filesystem::exists(prefix + ".index")) {
    GTEST_SKIP() << "no published network in " << test::referenceFolder();
  }
  const nn::TensorFile file = importCheckpoint(prefix);
  const std::vector<GateStep> approaching = analyse(file, "approaching").steps;
  const std::vector<GateStep> leaving = analyse(file, "leaving").steps;
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(approaching[i].mean, leaving[i].mean);
  }
  EXPECT_GT(approaching[5].state_part, approaching[4].state_part);
  EXPECT_LT(leaving[5].state_part, leaving[4].state_part);
  EXPECT_GT(approaching[5].mean, leaving[5].mean);
}

TEST(GateTable, HasARowForEachAgentOfEachScene) {
  const nn::TensorFile file = test::randomGa3cCadrl(4);
  std::ostringstream out;
  writeGatesCsv({analyse(file, "approaching"), analyse(file, "leaving")}, out);
  EXPECT_THAT(out.str(), HasSubstr("scene,agent,gap_m,state_part,hidden_part,bias_part,"));
  EXPECT_THAT(out.str(), HasSubstr("\napproaching,6,1.000,"));
  EXPECT_THAT(out.str(), HasSubstr("\nleaving,1,6.616,"));
}

TEST(GateFigure, IsABitmapAndVectors) {
  const test::ScratchFolder folder;
  drawGates({analyse(test::randomGa3cCadrl(5), "approaching")}, folder / "gates");
  EXPECT_GT(std::filesystem::file_size(folder / "gates.png"), 10000U);
  EXPECT_GT(std::filesystem::file_size(folder / "gates.svg"), 10000U);
}

TEST(GateFigure, ShowsASingleAgentToo) {
  const test::ScratchFolder folder;
  GateAnalysis analysis = analyse(test::randomGa3cCadrl(6), "approaching");
  const nn::TensorFile file = test::randomGa3cCadrl(6);
  analysis.scene.others.resize(1);
  analysis = analyseGates(*toGa3cCadrlWeights(file, "net"), "net", analysis.scene);
  ASSERT_EQ(analysis.steps.size(), 1U);
  drawGates({analysis}, folder / "gates");
  EXPECT_GT(std::filesystem::file_size(folder / "gates.png"), 10000U);
}

class GateSceneFile : public ::testing::Test {
 protected:
  std::string error(const std::string& yaml) {
    const std::string path = folder_ / "scene.yaml";
    std::ofstream(path) << yaml;
    const std::string text = test::startupErrorOf([&] { readGateScene(path); });
    return text.substr(std::min(text.size(), path.size()));
  }

  static constexpr const char* kEgo = "ego: {position_m: [0, 0], goal_m: [1, 1]}\n";

  test::ScratchFolder folder_;
};

TEST_F(GateSceneFile, NeedsTheEgosPlaceAndGoalAndSomebodyElse) {
  EXPECT_EQ(error(std::string(kEgo) + "others: [{position_m: [2, 2]}]\n"), "");
  EXPECT_EQ(error("ego: {goal_m: [1, 1]}\nothers: [{position_m: [2, 2]}]\n"),
            ":1: ego.position_m: expected [x, y], found nothing");
  EXPECT_EQ(error("ego: {position_m: [1, 1]}\nothers: [{position_m: [2, 2]}]\n"),
            ":1: ego.goal_m: expected [x, y], found nothing");
  EXPECT_EQ(error(std::string(kEgo) + "others: []\n"),
            ":2: others: expected at least one agent, found none");
  EXPECT_EQ(error(std::string(kEgo) + "others: [{radius_m: 1}]\n"),
            ":2: others[0].position_m: expected [x, y], found nothing");
}

TEST_F(GateSceneFile, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(error("ego: {postion_m: [0, 0]}\n"), HasSubstr("did you mean \"position_m\"?"));
  EXPECT_THAT(error("other: []\n"), HasSubstr("did you mean \"others\"?"));
  EXPECT_THAT(error("ego: {radius_m: 0}\n"), HasSubstr("expected a number above 0"));
}

TEST_F(GateSceneFile, MustBeThere) {
  EXPECT_EQ(test::startupErrorOf([] { readGateScene("/nowhere/scene.yaml"); }),
            "/nowhere/scene.yaml: scene: expected a file that can be read, found No such file or "
            "directory");
}

TEST_F(GateSceneFile, HeadsForItsGoalUnlessItSaysOtherwise) {
  const std::string path = folder_ / "scene.yaml";
  std::ofstream(path) << kEgo << "others: [{position_m: [2, 2]}]\n";
  EXPECT_DOUBLE_EQ(readGateScene(path).ego.heading_world_rad, std::atan2(1.0, 1.0));
}

}  // namespace
}  // namespace roundabout::planner
