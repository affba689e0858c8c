#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "learning/training/recipe.h"
#include "learning/training/trainer.h"
#include "learning/training/validation.h"

namespace roundabout::learning {

/// What it took to get where a run is, over all sessions.
struct Expense {
  double wall_s = 0.0;
  double cpu_s = 0.0;
};

/// Keeps other processes from writing to the same run.
class FolderLock {
 public:
  /// Throws core::StartupError if another process has it.
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(FolderLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FolderLock& operator=(FolderLock&&) = delete;
  ~FolderLock();

 private:
  int descriptor_;
};

/// The folder of one run of a recipe:
///   recipe.yaml             what is trained, complete
///   progress.csv            one row for each report
///   validation.csv          one row for each validation and number of agents
///   checkpoint.safetensors  where `--resume` continues
///   network.safetensors     the averaged network as it is
///   after_STAGE.safetensors what it was at the end of a stage that another followed
///   best.safetensors        that of the lowest validation cost so far
/// All files are whole at any time.
class RunFolder {
 public:
  /// A new folder. Throws core::StartupError if it is there already, or cannot be made. Nobody else
  /// can open it as long as this object lives.
  static RunFolder create(const std::string& path, const Recipe& recipe);
  /// Throws core::StartupError if there is no run, or somebody else has opened it.
  static RunFolder open(const std::string& path);
  /// Removes a run that could not begin, so that it can be begun again.
  void discard();

  const Recipe& recipe() const { return recipe_; }

  void saveCheckpoint(const Trainer& trainer, const Expense& expense);
  void saveStage(const Trainer& trainer, const Expense& expense, const Stage& stage);
  struct Checkpoint {
    TrainingState state;
    Expense expense;
  };
  /// Not before the first: such a run begins anew.
  bool hasCheckpoint() const;
  Checkpoint loadCheckpoint(const ParameterLayout& layout);

  void report(const Trainer& trainer, const Expense& expense, const IterationFigures& figures,
              double rolling_reward, double rolling_success);
  /// Keeps the network if it is the best so far. Returns whether it is.
  bool keep(const Trainer& trainer, const Expense& expense, const ValidationFigures& figures);

  /// As it flies: tensors and metadata.
  planner::nn::TensorFile networkFile(const Trainer& trainer, const Expense& expense,
                                      const std::string& figures) const;

  std::filesystem::path operator/(const std::string& file) const { return path_ / file; }

 private:
  RunFolder(std::filesystem::path path, Recipe recipe);

  std::filesystem::path path_;
  FolderLock lock_;
  Recipe recipe_;
  double best_cost_s_;
  std::ofstream progress_;
  std::ofstream validation_;
};

}  // namespace roundabout::learning
