#include "learning/evaluation/summary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <spdlog/fmt/fmt.h>

#include "learning/evaluation/case_file.h"

namespace roundabout::learning {

namespace {

using nlohmann::json;

std::string timesText(const ExtraTimes& times) {
  return times.cases == 0 ? "-"
                          : fmt::format("{:.3f} / {:.3f} / {:.3f}", times.mean_s,
                                        times.percentile75_s, times.percentile90_s);
}

/// One agent without obstacles is apart from nothing.
std::string separationText(const Score& score) {
  return std::isfinite(score.closest_separation_m)
             ? fmt::format("{:.3f} {:>7.3f}", score.closest_separation_m,
                           score.mean_closest_separation_m)
             : "-";
}

json timesJson(const ExtraTimes& times) {
  if (times.cases == 0) {
    return {
        {"cases", 0}, {"mean", nullptr}, {"percentile_75", nullptr}, {"percentile_90", nullptr}};
  }
  return {{"cases", times.cases},
          {"mean", times.mean_s},
          {"percentile_75", times.percentile75_s},
          {"percentile_90", times.percentile90_s}};
}

json finiteOrNull(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

// How much of what the shielded wanted was changed, and by which layer.
std::string interventionsText(const Evaluation& evaluation, const std::vector<Score>& scores,
                              std::size_t width) {
  std::string text;
  for (const Score& score : scores) {
    if (!evaluation.contestants[score.contestant].shielded) {
      continue;
    }
    if (text.empty()) {
      text = fmt::format("\n{:<{}}  {:<12}  {:>9}", "steps changed, %", width, "cases", "all");
      for (std::size_t i = 1; i < kShieldLayers; ++i) {
        text += fmt::format("  {:>10}", nameOf(static_cast<planner::shield::Layer>(i)));
      }
      text += '\n';
    }
    text += fmt::format("{:<{}}  {:<12}  {:>9.2f}", labelOf(evaluation, score.contestant), width,
                        evaluation.suite.groups[score.group].name, 100.0 * score.changedShare());
    for (std::size_t i = 1; i < kShieldLayers; ++i) {
      text += fmt::format("  {:>10.2f}", 100.0 * score.layer_shares[i]);
    }
    text += '\n';
  }
  return text;
}

json layersJson(const Score& score) {
  json layers = json::object();
  for (std::size_t i = 1; i < kShieldLayers; ++i) {
    layers[nameOf(static_cast<planner::shield::Layer>(i))] = score.layer_shares[i];
  }
  return layers;
}

}  // namespace

std::string shortLabel(const std::string& specification) {
  const std::size_t colon = specification.find(':');
  if (colon == std::string::npos) {
    return specification;
  }
  return fmt::format("{} ({})", specification.substr(0, colon),
                     std::filesystem::path(specification.substr(colon + 1)).stem().string());
}

std::string labelOf(const Evaluation& evaluation, std::size_t contestant) {
  const std::string suffix = evaluation.contestants[contestant].shielded ? " + shield" : "";
  const std::string& specification = evaluation.contestants[contestant].specification;
  const std::string label = shortLabel(specification);
  const auto namesakes = std::count_if(
      evaluation.contestants.begin(), evaluation.contestants.end(), [&](const Contestant& other) {
        return shortLabel(other.specification) == label && other.specification != specification;
      });
  return (namesakes > 0 ? specification : label) + suffix;
}

std::string summaryText(const Evaluation& evaluation, const std::vector<Score>& scores) {
  std::size_t width = 6;
  for (std::size_t i = 0; i < evaluation.contestants.size(); ++i) {
    width = std::max(width, labelOf(evaluation, i).size());
  }
  std::string text =
      fmt::format("{}, rules \"{}\"\n", evaluation.suite.name, evaluation.rules.name);
  std::size_t group = evaluation.suite.groups.size();
  for (const Score& score : scores) {
    if (score.group != group) {
      group = score.group;
      text += fmt::format("\n{}, {}\n{:<{}}  {:>9}  {:>11}  {:>7}  {:<23}  {:<23}  {:>14}\n",
                          evaluation.suite.groups[group].name, casesText(score.cases), "policy",
                          width, "success %", "collision %", "stuck %", "extra s: own successes",
                          fmt::format("solved by all ({})", score.common.cases), "separation m");
    }
    text += fmt::format("{:<{}}  {:>9.1f}  {:>11.1f}  {:>7.1f}  {:<23}  {:<23}  {:>14}\n",
                        labelOf(evaluation, score.contestant), width, 100.0 * score.success_share,
                        100.0 * score.collision_share, 100.0 * score.stuck_share,
                        timesText(score.own), timesText(score.common), separationText(score));
  }
  text += interventionsText(evaluation, scores, width);
  text +=
      "\nextra s: mean / 75th / 90th percentile over cases of the mean extra time to goal\n"
      "separation m: closest of all cases, and mean over cases of the closest, between edges\n";
  if (evaluation.mix) {
    text += fmt::format("mixed: {:.0f} % of the agents of every case run {} (seed {})\n",
                        100.0 * evaluation.mix->share,
                        shortLabel(evaluation.mix->others.specification), evaluation.mix->seed);
  }
  text += "\nRules:\n";
  for (const std::string& sentence : evaluation.rules.sentences()) {
    text += "- " + sentence + "\n";
  }
  return text;
}

json summaryJson(const Evaluation& evaluation, const std::vector<Score>& scores) {
  json rows = json::array();
  for (const Score& score : scores) {
    const CaseGroup& group = evaluation.suite.groups[score.group];
    const Contestant& contestant = evaluation.contestants[score.contestant];
    rows.push_back({{"policy", contestant.specification},
                    {"shield", contestant.shielded},
                    {"changed_by_layer", contestant.shielded ? layersJson(score) : json(nullptr)},
                    {"group", group.name},
                    {"agents", group.cases.front().agents.size()},
                    {"cases", score.cases},
                    {"success", score.success_share},
                    {"collision", score.collision_share},
                    {"stuck", score.stuck_share},
                    {"extra_time_s", timesJson(score.own)},
                    {"extra_time_s_solved_by_all", timesJson(score.common)},
                    {"closest_separation_m", finiteOrNull(score.closest_separation_m)},
                    {"mean_closest_separation_m", finiteOrNull(score.mean_closest_separation_m)}});
  }
  return {{"suite", evaluation.suite.name},
          {"rules", {{"name", evaluation.rules.name}, {"text", evaluation.rules.sentences()}}},
          {"scores", rows}};
}

}  // namespace roundabout::learning
