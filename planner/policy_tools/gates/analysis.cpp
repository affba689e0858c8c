#include "planner/policy_tools/gates/analysis.h"

#include <ostream>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ostr.h>

#include "common/core/error.h"

namespace roundabout::planner {

GateAnalysis analyseGates(const Ga3cCadrlWeights& weights, const std::string& path,
                          GateScene scene) {
  const RecurrentReader* reader = std::get_if<RecurrentReader>(&weights.others);
  if (reader == nullptr) {
    throw core::StartupError(path, "metadata architecture", "a network with an LSTM",
                             "one whose other agents share weights");
  }
  GateAnalysis analysis;
  ObservationEncoder encoder(weights.max_others, weights.others_order);
  analysis.observation = encoder.encode(scene.ego, scene.others);
  std::vector<OtherInput> inputs;
  for (const OtherFeatures& features : analysis.observation.others) {
    inputs.push_back(weights.normalisedOther(features));
  }
  analysis.steps = inputGateDynamics(*reader, inputs);
  analysis.scene = std::move(scene);
  return analysis;
}

void writeGatesCsv(const std::vector<GateAnalysis>& analyses, std::ostream& out) {
  out << "scene,agent,gap_m,state_part,hidden_part,bias_part,mean_input_gate\n";
  for (const GateAnalysis& analysis : analyses) {
    for (std::size_t i = 0; i < analysis.steps.size(); ++i) {
      const GateStep& step = analysis.steps[i];
      out << fmt::format("{},{},{:.3f},{:.6f},{:.6f},{:.6f},{:.6f}\n", analysis.scene.name, i + 1,
                         analysis.observation.others[i].back(), step.state_part, step.hidden_part,
                         step.bias_part, step.mean);
    }
  }
}

}  // namespace roundabout::planner
