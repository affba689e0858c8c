#include "learning/training/recipe.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include <spdlog/fmt/fmt.h>

#include "common/config/document.h"
#include "common/config/reader.h"
#include "common/config/writer.h"
#include "common/core/error.h"

namespace roundabout::learning {

using config::above;
using config::atLeast;
using config::between;

template <class Visitor>
void describe(Visitor& visit, Stage& stage) {
  visit("name", stage.name);
  visit("world", stage.world, config::oneOf({"ideal", "lab"}));
  visit("agent_steps", stage.agent_steps, above(0.0));
  visit("min_agents", stage.min_agents, between(1.0, 40.0));
  visit("max_agents", stage.max_agents, between(1.0, 40.0));
  visit("planning_step_s", stage.planning_step_s, between(0.01, 1.0));
  visit("learning_rate", stage.learning_rate);
  visit("entropy_weight", stage.entropy_weight);
  visit("collision_reward", stage.collision_reward);
  visit("trap_share", stage.trap_share, between(0.0, 1.0));
  visit("sharp_share", stage.sharp_share, between(0.0, 1.0));
  visit("sharpness", stage.sharpness, above(0.0));
  visit("hard_share", stage.hard_share, between(0.0, 0.9));
  visit("lab_variation", stage.lab_variation, between(0.0, 0.9));
}

template <class Visitor>
void describe(Visitor& visit, Crowd& crowd) {
  visit("non_cooperative_share", crowd.non_cooperative_share, between(0.0, 0.9));
  visit("static_share", crowd.static_share, between(0.0, 0.9));
  visit("turned_share", crowd.turned_share, between(0.0, 1.0));
  visit("wide_speeds_share", crowd.wide_speeds_share, between(0.0, 1.0));
  visit("published_square_share", crowd.published_square_share, between(0.0, 1.0));
  visit("numbers_exponent", crowd.numbers_exponent, between(-3.0, 3.0));
}

template <class Visitor>
void describe(Visitor& visit, Ppo& ppo) {
  visit("environments", ppo.environments, between(1.0, 100000.0));
  visit("steps", ppo.steps, between(1.0, 10000.0));
  visit("lab_episodes", ppo.lab_episodes, between(1.0, 100000.0));
  visit("epochs", ppo.epochs, between(1.0, 100.0));
  visit("minibatch", ppo.minibatch, between(1.0, 1e6));
  visit("clip", ppo.clip, between(0.0, 1.0));
  visit("trace_decay", ppo.trace_decay, between(0.0, 1.0));
  visit("value_weight", ppo.value_weight, atLeast(0.0));
  visit("mirrored_share", ppo.mirrored_share, between(0.0, 1.0));
  visit("max_gradient_norm", ppo.max_gradient_norm, above(0.0));
  visit("max_divergence", ppo.max_divergence, above(0.0));
  visit("averaged_updates", ppo.averaged_updates, atLeast(1.0));
}

template <class Visitor>
void describe(Visitor& visit, Imitation& imitation) {
  visit("updates", imitation.updates, between(0.0, 1e9));
  visit("batch", imitation.batch, between(1.0, 1e6));
  visit("learning_rate", imitation.learning_rate, above(0.0));
  visit("cases", imitation.cases, between(1.0, 1e6));
}

template <class Visitor>
void describe(Visitor& visit, Ga3c& ga3c) {
  visit("environments", ga3c.environments, between(1.0, 100000.0));
  visit("return_steps", ga3c.return_steps, between(1.0, 10000.0));
  visit("batch", ga3c.batch, between(1.0, 1e6));
  visit("prediction_batch", ga3c.prediction_batch, between(1.0, 1e6));
  visit("iteration_samples", ga3c.iteration_samples, atLeast(1.0));
}

template <class Visitor>
void describe(Visitor& visit, Validation& validation) {
  visit("every_agent_steps", validation.every_agent_steps, above(0.0));
  visit("agents", validation.agents, between(1.0, 100.0));
  visit("rules", validation.rules, config::oneOf({"published", "lab"}));
  visit("cases", validation.cases, between(1.0, 100000.0));
  visit("seed", validation.seed);
}

template <class Visitor>
void describe(Visitor& visit, Recipe& recipe) {
  visit("network", recipe.network, config::oneOf({"pool", "lstm", "ws", "attention"}));
  visit("engine", recipe.engine, config::oneOf({"auto", "torch"}));
  visit("max_others", recipe.max_others, between(1.0, 100.0));
  visit("others_order", recipe.others_order,
        config::oneOf({"closest_last", "closest_first", "time_to_collision"}));
  visit("algorithm", recipe.algorithm, config::oneOf({"ppo", "ga3c"}));
  visit("begin_with", recipe.begin_with);
  visit("seed", recipe.seed);
  visit("shards", recipe.shards, between(1.0, 256.0));
  visit("potential", recipe.potential);
  visit("checkpoint_agent_steps", recipe.checkpoint_agent_steps, above(0.0));
  visit("imitation", recipe.imitation);
  visit("ppo", recipe.ppo);
  visit("ga3c", recipe.ga3c);
  visit("crowd", recipe.crowd);
  visit("validation", recipe.validation);
  visit("stages", recipe.stages);
}

std::string fileNameOf(const Stage& stage) {
  std::string name = stage.name;
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char character) { return std::isalnum(character) == 0; }, '_');
  return name;
}

StagePlace stageAt(const Recipe& recipe, double agent_steps) {
  for (const Stage& stage : recipe.stages) {
    if (agent_steps < stage.agent_steps) {
      return {&stage, agent_steps / stage.agent_steps};
    }
    agent_steps -= stage.agent_steps;
  }
  return {&recipe.stages.back(), 1.0};
}

double totalAgentSteps(const Recipe& recipe) {
  double total = 0.0;
  for (const Stage& stage : recipe.stages) {
    total += stage.agent_steps;
  }
  return total;
}

Recipe parseRecipe(const std::string& yaml, const std::string& file,
                   const std::vector<std::string>& overrides) {
  const config::Document document(yaml, file, overrides);
  Recipe recipe;
  config::Reader reader(document, document.root(), "");
  describe(reader, recipe);
  reader.finish();
  if (recipe.stages.empty()) {
    document.fail("stages", "at least one stage", "none");
  }
  if (recipe.validation.agents.empty()) {
    document.fail("validation.agents", "at least one number of agents", "none");
  }
  const bool ga3c = recipe.algorithm == "ga3c";
  if (!ga3c && recipe.ppo.minibatch < recipe.shards) {
    document.fail("ppo.minibatch",
                  fmt::format("at least one sample for each of {} shards", recipe.shards),
                  fmt::format("{}", recipe.ppo.minibatch));
  }
  if (ga3c && recipe.ppo.mirrored_share > 0.0) {
    document.fail("ppo.mirrored_share", "0, with ga3c",
                  fmt::format("{}", recipe.ppo.mirrored_share));
  }
  std::map<std::string, std::size_t> names;
  for (std::size_t i = 0; i < recipe.stages.size(); ++i) {
    Stage& stage = recipe.stages[i];
    if (stage.name.empty()) {
      stage.name = fmt::format("stage {}", i + 1);
    }
    if (stage.name.find_first_of(",\"\n\r") != std::string::npos) {
      document.fail(fmt::format("stages[{}].name", i), "no comma, quote or line break (of a table)",
                    stage.name);
    }
    if (const auto [same, is_new] = names.emplace(fileNameOf(stage), i); !is_new) {
      document.fail(fmt::format("stages[{}].name", i),
                    fmt::format("another name than that of stages[{}] (after_{}.safetensors is "
                                "written once)",
                                same->second, same->first),
                    stage.name);
    }
    if (ga3c && stage.sharp_share > 0.0) {
      document.fail("stages[" + std::to_string(i) + "].sharp_share", "0, with ga3c",
                    fmt::format("{}", stage.sharp_share));
    }
    if (stage.hard_share > 0.0 && (ga3c || stage.world != "ideal")) {
      document.fail("stages[" + std::to_string(i) + "].hard_share",
                    ga3c ? "0, with ga3c" : "0, in the lab", fmt::format("{}", stage.hard_share));
    }
    if (stage.max_agents < stage.min_agents) {
      document.fail("stages[" + std::to_string(i) + "].max_agents",
                    "at least " + std::to_string(stage.min_agents),
                    std::to_string(stage.max_agents));
    }
    if (ga3c && stage.world != "ideal") {
      document.fail("stages[" + std::to_string(i) + "].world", "ideal, with ga3c", stage.world);
    }
  }
  return recipe;
}

Recipe readRecipe(const std::string& path, const std::vector<std::string>& overrides) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw core::StartupError(path, "recipe", "a file that can be read", std::strerror(errno));
  }
  return parseRecipe(text.str(), path, overrides);
}

std::string writeRecipe(const Recipe& recipe) {
  Recipe copy = recipe;
  config::Writer writer;
  writer.write(copy);
  return writer.text();
}

}  // namespace roundabout::learning
