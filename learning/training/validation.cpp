#include "learning/training/validation.h"

#include <cmath>
#include <memory>

#include "learning/evaluation/case_file.h"
#include "learning/evaluation/generate.h"
#include "planner/policies/ga3c_cadrl/ga3c_cadrl.h"
#include "planner/policies/ga3c_cadrl/weights.h"

namespace roundabout::learning {

std::optional<ValidationFigures> validate(const Validation& validation,
                                          const planner::nn::TensorFile& network, int threads,
                                          const std::function<bool()>& keep_going) {
  Evaluation evaluation;
  evaluation.rules = makeRules(validation.rules);
  evaluation.contestants.push_back(
      {"training", std::make_unique<planner::Ga3cCadrl>(
                       planner::toGa3cCadrlWeights(network, "network in training"))});
  for (const int agents : validation.agents) {
    GeneratorSettings settings;
    settings.agents = agents;
    evaluation.suite.groups.push_back(
        {agentsText(static_cast<std::size_t>(agents)),
         generateCases("mixed", settings, validation.cases, validation.seed)});
  }
  std::vector<EpisodeResult> results;
  const bool whole = runAll(
      evaluation, 0, threads,
      [&](std::size_t, const EpisodeResult& result) { results.push_back(result); }, keep_going);
  if (!whole) {
    return std::nullopt;
  }
  ValidationFigures figures;
  figures.scores = scoresOf(evaluation, results);
  for (const Score& score : figures.scores) {
    // A network that never arrives has no extra time.
    const double extra_time_s = std::isnan(score.own.mean_s) ? kFailureCost_s : score.own.mean_s;
    const auto share = 1.0 / static_cast<double>(figures.scores.size());
    figures.success_share += share * score.success_share;
    figures.extra_time_s += share * extra_time_s;
    figures.cost_s += share * (extra_time_s + kFailureCost_s * (1.0 - score.success_share));
  }
  return figures;
}

}  // namespace roundabout::learning
