#include "learning/evaluation/run_description.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <spdlog/fmt/fmt.h>

#include "planner/policies/table.h"

namespace roundabout::learning {

namespace {

using nlohmann::json;

/// FNV-1a, in hexadecimal digits.
std::string hashOf(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  }
  return fmt::format("{:016x}", hash);
}

/// Every number of every case.
std::string textOf(const Suite& suite) {
  std::string text;
  const auto add = [&](const Eigen::Vector2d& point) {
    text += fmt::format("{} {} ", point.x(), point.y());
  };
  for (const CaseGroup& group : suite.groups) {
    text += group.name + ":";
    for (const TestCase& each : group.cases) {
      for (const AgentSpec& agent : each.agents) {
        add(agent.start_m);
        add(agent.goal_m);
        text += fmt::format("{} {} ", agent.radius_m, agent.preferred_speed_mps);
      }
      for (const auto& goals_m : each.later_goals_m) {
        std::for_each(goals_m.begin(), goals_m.end(), add);
      }
      for (const core::Polygon& obstacle : each.obstacles) {
        text += "obstacle ";
        std::for_each(obstacle.begin(), obstacle.end(), add);
      }
    }
  }
  return text;
}

/// A policy and what its weight file holds.
json describe(const Contestant& contestant) {
  const std::string& specification = contestant.specification;
  json description = {{"policy", specification}, {"shielded", contestant.shielded}};
  const std::string weights = planner::weightsOf(specification);
  if (!weights.empty()) {
    std::ifstream file(weights, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    description["weights_hash"] = hashOf(bytes);
  }
  return description;
}

json describeMix(const Mix& mix) {
  return {{"policy", describe(mix.others)},
          {"shielded", mix.shielded},
          {"share", mix.share},
          {"seed", mix.seed}};
}

}  // namespace

json describeRun(const Evaluation& evaluation) {
  json policies = json::array();
  for (const Contestant& contestant : evaluation.contestants) {
    policies.push_back(describe(contestant));
  }
  return {{"policies", policies},
          {"suite", evaluation.suite.name},
          {"cases", evaluation.casesPerContestant()},
          {"cases_hash", hashOf(textOf(evaluation.suite))},
          {"rules", {{"name", evaluation.rules.name}, {"text", evaluation.rules.sentences()}}},
          {"mix", evaluation.mix ? describeMix(*evaluation.mix) : json(nullptr)}};
}

}  // namespace roundabout::learning
