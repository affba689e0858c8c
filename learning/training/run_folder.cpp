#include "learning/training/run_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <unistd.h>

#include "common/core/error.h"
#include "learning/training/weight_files.h"

namespace roundabout::learning {

namespace {

using core::StartupError;
using planner::nn::TensorFile;

constexpr const char* kCheckpoint = "checkpoint.safetensors";
constexpr const char* kRecipe = "recipe.yaml";

constexpr const char* kProgressColumns =
    "wall_s,cpu_s,iteration,agent_steps,episodes,stage,reward,success,divergence,clipped,entropy,"
    "value_error,learning_rate,cut_short\n";
constexpr const char* kValidationColumns =
    "wall_s,cpu_s,agent_steps,agents,cases,success,collision,stuck,extra_time_s,cost_s\n";

std::ofstream openTable(const std::filesystem::path& path, const char* columns) {
  const bool is_new = !std::filesystem::exists(path);
  std::ofstream table(path, std::ios::app);
  if (!table) {
    throw StartupError(path.string(), "run", "a file that can be written", "an error");
  }
  if (is_new) {
    table << columns;
  }
  return table;
}

template <class Number>
Number numberIn(const TensorFile& file, const std::string& key, const std::string& path) {
  const auto entry = file.metadata.find(key);
  const nlohmann::json value = entry == file.metadata.end()
                                   ? nlohmann::json()
                                   : nlohmann::json::parse(entry->second, nullptr, false);
  if (!value.is_number()) {
    throw StartupError(path, "metadata " + key, "a number", "something else");
  }
  return value.get<Number>();
}

std::string compiler() { return fmt::format("GCC {}", __VERSION__); }

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    throw StartupError(folder.string(), "run", "a folder that nobody else trains in",
                       error == EWOULDBLOCK ? "another process that does" : std::strerror(error));
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

RunFolder::RunFolder(std::filesystem::path path, Recipe recipe)
    : path_(std::move(path)),
      lock_(path_),
      recipe_(std::move(recipe)),
      best_cost_s_(std::numeric_limits<double>::infinity()),
      progress_(openTable(path_ / "progress.csv", kProgressColumns)),
      validation_(openTable(path_ / "validation.csv", kValidationColumns)) {}

RunFolder RunFolder::create(const std::string& path, const Recipe& recipe) {
  if (std::filesystem::exists(path)) {
    throw StartupError(path, "run", "a folder that is not there yet",
                       "one that is (--resume continues it)");
  }
  std::error_code error;
  std::filesystem::create_directories(path, error);
  std::ofstream file(std::filesystem::path(path) / kRecipe);
  file << writeRecipe(recipe);
  if (!file.flush()) {
    throw StartupError(path, "run", "a folder that can be written",
                       error ? error.message() : "an error");
  }
  return {path, recipe};
}

RunFolder RunFolder::open(const std::string& path) {
  const std::filesystem::path folder(path);
  if (!std::filesystem::exists(folder / kRecipe)) {
    throw StartupError(path, "run", std::string("a folder with ") + kRecipe, "none");
  }
  return {folder, readRecipe((folder / kRecipe).string(), {})};
}

void RunFolder::discard() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

bool RunFolder::hasCheckpoint() const { return std::filesystem::exists(path_ / kCheckpoint); }

void RunFolder::saveCheckpoint(const Trainer& trainer, const Expense& expense) {
  const TrainingState& state = trainer.state();
  TensorFile file;
  trainer.layout().write(state.parameters, "parameters/", file);
  trainer.layout().write(state.averaged, "averaged/", file);
  trainer.layout().write(state.adam.first, "adam_first/", file);
  trainer.layout().write(state.adam.second, "adam_second/", file);
  const auto note = [&](const char* key, auto number) {
    file.metadata[key] = nlohmann::json(number).dump();
  };
  note("updates", state.adam.updates);
  note("iterations", state.iterations);
  note("agent_steps", state.agent_steps);
  note("episodes", state.episodes);
  note("wall_s", expense.wall_s);
  note("cpu_s", expense.cpu_s);
  note("best_cost_s", std::min(best_cost_s_, 1e9));
  planner::nn::writeSafetensors(*this / kCheckpoint, file);
  planner::nn::writeSafetensors(*this / "network.safetensors",
                                networkFile(trainer, expense, "not judged"));
}

void RunFolder::saveStage(const Trainer& trainer, const Expense& expense, const Stage& stage) {
  planner::nn::writeSafetensors(*this / ("after_" + fileNameOf(stage) + ".safetensors"),
                                networkFile(trainer, expense, "not judged"));
}

RunFolder::Checkpoint RunFolder::loadCheckpoint(const ParameterLayout& layout) {
  const std::string path = *this / kCheckpoint;
  const TensorFile file = planner::nn::readSafetensors(path);
  Checkpoint checkpoint{TrainingState(layout.size()), {}};
  TrainingState& state = checkpoint.state;
  state.parameters = layout.read(file, "parameters/", path);
  state.averaged = layout.read(file, "averaged/", path);
  state.adam.first = layout.read(file, "adam_first/", path);
  state.adam.second = layout.read(file, "adam_second/", path);
  state.adam.updates = numberIn<long>(file, "updates", path);
  state.iterations = numberIn<long>(file, "iterations", path);
  state.agent_steps = numberIn<long>(file, "agent_steps", path);
  state.episodes = numberIn<long>(file, "episodes", path);
  checkpoint.expense = {numberIn<double>(file, "wall_s", path),
                        numberIn<double>(file, "cpu_s", path)};
  best_cost_s_ = numberIn<double>(file, "best_cost_s", path);
  return checkpoint;
}

void RunFolder::report(const Trainer& trainer, const Expense& expense,
                       const IterationFigures& figures, double rolling_reward,
                       double rolling_success) {
  const TrainingState& state = trainer.state();
  const auto agent_steps = static_cast<double>(state.agent_steps);
  progress_
      << fmt::format(
             "{:.1f},{:.1f},{},{},{},{},{:.4f},{:.4f},{:.5f},{:.4f},{:.4f},{:.6f},{:.3e},{}\n",
             expense.wall_s, expense.cpu_s, state.iterations, state.agent_steps, state.episodes,
             stageAt(recipe_, agent_steps).stage->name, rolling_reward, rolling_success,
             figures.loss.divergence, figures.loss.clipped, figures.loss.entropy,
             figures.loss.value_error, figures.learning_rate, figures.cut_short ? 1 : 0)
      << std::flush;
}

bool RunFolder::keep(const Trainer& trainer, const Expense& expense,
                     const ValidationFigures& figures) {
  nlohmann::json table = nlohmann::json::object();
  for (std::size_t k = 0; k < figures.scores.size(); ++k) {
    const Score& score = figures.scores[k];
    const int agents = recipe_.validation.agents[k];
    validation_ << fmt::format("{:.1f},{:.1f},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n",
                               expense.wall_s, expense.cpu_s, trainer.state().agent_steps, agents,
                               score.cases, score.success_share, score.collision_share,
                               score.stuck_share, score.own.mean_s, figures.cost_s);
    table[std::to_string(agents)] = {{"success", score.success_share},
                                     {"collision", score.collision_share},
                                     {"stuck", score.stuck_share},
                                     {"extra_time_s", score.own.mean_s}};
  }
  validation_ << std::flush;
  if (figures.cost_s >= best_cost_s_) {
    return false;
  }
  best_cost_s_ = figures.cost_s;
  planner::nn::writeSafetensors(*this / "best.safetensors",
                                networkFile(trainer, expense, table.dump()));
  return true;
}

TensorFile RunFolder::networkFile(const Trainer& trainer, const Expense& expense,
                                  const std::string& figures) const {
  const TrainingState& state = trainer.state();
  TensorFile file = weightFile(
      trainer.plan(), state.averaged,
      fmt::format("trained by roundabout train from {}, seed {}, {} agent-steps, {} updates, "
                  "{:.0f} s of computing, {}",
                  recipe_.begin_with.empty() ? "nothing" : recipe_.begin_with, recipe_.seed,
                  state.agent_steps, state.adam.updates, expense.cpu_s, compiler()));
  file.metadata["validation"] = figures;
  file.metadata["recipe"] = writeRecipe(recipe_);
  return file;
}

}  // namespace roundabout::learning
