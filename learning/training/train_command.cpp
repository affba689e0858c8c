#include "learning/training/train_command.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <thread>

#include <spdlog/fmt/fmt.h>

#include "common/app/stop_signal.h"
#include "common/core/error.h"
#include "learning/training/run_folder.h"
#include "learning/training/training_figure.h"

namespace roundabout::learning {

namespace {

constexpr int kInterrupted = 130;
constexpr double kReportEvery_s = 10.0;
constexpr double kRollingEpisodes = 1000.0;

struct Options {
  std::string recipe;
  std::string folder;
  std::vector<std::string> overrides;
  std::vector<std::string> plotted;
  std::optional<std::uint64_t> seed;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool resume = false;
};

/// Wall clock and computing time of this process, on top of what was spent before.
class Stopwatch {
 public:
  explicit Stopwatch(const Expense& before) : before_(before) {}

  Expense read() const {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - began_;
    return {before_.wall_s + wall.count(), before_.cpu_s + cpu() - cpu_began_};
  }

 private:
  static double cpu() {
    return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
  }

  Expense before_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  double cpu_began_ = cpu();
};

/// Mean over about the last thousand episodes.
class RollingMean {
 public:
  void add(double mean, double count) {
    if (count <= 0.0) {
      return;
    }
    const double weight =
        std::max(count / (seen_ + count), 1.0 - std::exp(-count / kRollingEpisodes));
    seen_ += count;
    mean_ += weight * (mean - mean_);
  }
  double value() const { return mean_; }

 private:
  double mean_ = 0.0;
  double seen_ = 0.0;
};

/// One session of training: from where the run is to its end, or to an interruption.
class Session {
 public:
  Session(RunFolder folder, const Options& options)
      : folder_(std::move(folder)), threads_(options.threads) {
    const Recipe& recipe = folder_.recipe();
    if (options.resume && folder_.hasCheckpoint()) {
      RunFolder::Checkpoint checkpoint = folder_.loadCheckpoint(networkPlan(recipe).layout());
      watch_.emplace(checkpoint.expense);
      trainer_ = makeTrainer(recipe, threads_, std::move(checkpoint.state));
    } else {
      watch_.emplace(Expense());  // a supervised start counts
      beginAnew(options.resume);
    }
    first_wall_s_ = watch_->read().wall_s;
    first_steps_ = trainer_->state().agent_steps;
    last_validation_ = last_checkpoint_ = first_steps_;
  }

  /// False: interrupted.
  bool run() {
    const auto total = static_cast<long>(totalAgentSteps(folder_.recipe()));
    const Recipe& recipe = folder_.recipe();
    if (trainer_->state().agent_steps >= total) {
      // It may have been interrupted while it was judged last.
      return judgeAndSave();
    }
    while (trainer_->state().agent_steps < total) {
      const Stage& stage = stageNow();
      const IterationFigures figures = trainer_->iterate();
      reward_.add(figures.reward, static_cast<double>(figures.episodes));
      success_.add(figures.success, static_cast<double>(figures.episodes));
      const long steps = trainer_->state().agent_steps;
      const bool ended = steps >= total;
      if (ended || stop_.requested() || watch_->read().wall_s - last_report_s_ >= kReportEvery_s) {
        report(figures, total);
      }
      if (ended) {
        trainer_->renewEnvironments();
        return judgeAndSave();
      }
      if (&stageNow() != &stage) {
        folder_.saveStage(*trainer_, watch_->read(), stage);
      }
      if (passed(last_validation_, steps, recipe.validation.every_agent_steps)) {
        judge();
      }
      if (passed(last_checkpoint_, steps, recipe.checkpoint_agent_steps)) {
        trainer_->renewEnvironments();
        folder_.saveCheckpoint(*trainer_, watch_->read());
      }
      if (stop_.requested()) {
        trainer_->renewEnvironments();
        folder_.saveCheckpoint(*trainer_, watch_->read());
        return false;
      }
    }
    return true;
  }

 private:
  void beginAnew(bool keep_folder) {
    try {
      trainer_ = makeTrainer(folder_.recipe(), threads_, initialState(folder_.recipe()));
    } catch (...) {
      if (!keep_folder) {
        folder_.discard();
      }
      throw;
    }
    if (folder_.recipe().imitation.updates > 0) {
      folder_.saveCheckpoint(*trainer_, watch_->read());
    }
  }

  /// Whether a multiple of `every` lies between the last time and now.
  static bool passed(long& last, long now, double every) {
    const bool is_due = static_cast<long>(static_cast<double>(now) / every) >
                        static_cast<long>(static_cast<double>(last) / every);
    last = now;
    return is_due;
  }

  const Stage& stageNow() const {
    const auto steps = static_cast<double>(trainer_->state().agent_steps);
    return *stageAt(folder_.recipe(), steps).stage;
  }

  void report(const IterationFigures& figures, long total) {
    const Expense spent = watch_->read();
    last_report_s_ = spent.wall_s;
    folder_.report(*trainer_, spent, figures, reward_.value(), success_.value());
    const long steps = trainer_->state().agent_steps;
    const double rate = static_cast<double>(steps - first_steps_) / (spent.wall_s - first_wall_s_);
    fmt::print(stderr,
               "{:.1f} of {:.1f} M agent-steps, {:.0f}/s, {} episodes, reward {:.3f}, success "
               "{:.3f}, {:.0f} min left\n",
               1e-6 * static_cast<double>(steps), 1e-6 * static_cast<double>(total), rate,
               trainer_->state().episodes, reward_.value(), success_.value(),
               static_cast<double>(total - steps) / rate / 60.0);
  }

  /// Of a run at its end. False: interrupted.
  bool judgeAndSave() {
    folder_.saveCheckpoint(*trainer_, watch_->read());
    if (!judge()) {
      return false;
    }
    folder_.saveCheckpoint(*trainer_, watch_->read());
    return true;
  }

  /// False: interrupted.
  bool judge() {
    const auto figures = validate(folder_.recipe().validation,
                                  folder_.networkFile(*trainer_, watch_->read(), "being judged"),
                                  threads_, [this] { return !stop_.requested(); });
    if (!figures) {
      return false;
    }
    const bool best = folder_.keep(*trainer_, watch_->read(), *figures);
    fmt::print(stderr, "validation: success {:.4f}, extra time {:.3f} s, cost {:.3f} s{}\n",
               figures->success_share, figures->extra_time_s, figures->cost_s,
               best ? ", the best so far" : "");
    return true;
  }

  app::StopSignal stop_;
  RunFolder folder_;
  int threads_;
  std::unique_ptr<Trainer> trainer_;
  std::optional<Stopwatch> watch_;
  RollingMean reward_;
  RollingMean success_;
  double first_wall_s_ = 0.0;
  long first_steps_ = 0;
  long last_validation_ = 0;
  long last_checkpoint_ = 0;
  double last_report_s_ = -kReportEvery_s;
};

RunFolder folderOf(const Options& options) {
  if (options.folder.empty()) {
    throw core::StartupError("train", "--out", "a folder for the run", "none");
  }
  if (options.resume) {
    if (!options.recipe.empty() || !options.overrides.empty() || options.seed) {
      throw core::StartupError("train", "--resume",
                               "no RECIPE, --set or --seed: the run has its own",
                               !options.recipe.empty()     ? options.recipe
                               : options.overrides.empty() ? fmt::format("--seed {}", *options.seed)
                                                           : options.overrides.front());
    }
    return RunFolder::open(options.folder);
  }
  if (options.recipe.empty()) {
    throw core::StartupError("train", "RECIPE", "a file", "none");
  }
  Recipe recipe = readRecipe(options.recipe, options.overrides);
  recipe.seed = options.seed.value_or(recipe.seed);
  return RunFolder::create(options.folder, recipe);
}

int train(const Options& options) {
  if (!options.plotted.empty()) {
    fmt::print("{}\n",
               drawTraining(options.plotted, options.folder.empty() ? "." : options.folder));
    return 0;
  }
  Session session(folderOf(options), options);
  if (!session.run()) {
    fmt::print(stderr, "stopped; go on with: roundabout train --resume --out {}\n", options.folder);
    return kInterrupted;
  }
  fmt::print("{}\n", options.folder);
  return 0;
}

}  // namespace

void addTrainCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("train", "Train a policy by a recipe");
  auto options = std::make_shared<Options>();
  command->add_option("recipe", options->recipe, "A file; experiments/training/ holds some");
  command->add_option("--out", options->folder, "Folder of the run, or of the picture");
  command->add_option("--set", options->overrides, "key=value instead of the recipe's; repeatable")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--seed", options->seed, "Instead of the recipe's");
  command
      ->add_option("--threads", options->threads,
                   "Default: one a core; changes no result but with ga3c")
      ->check(CLI::Range(1, 1024));
  command->add_option("--plot", options->plotted,
                      "Draw how the rolling reward of these runs grew, mean and deviation; folders "
                      "NAME.SEED of one NAME are a band of their own");
  command->add_flag("--resume", options->resume, "Go on where the run in --out was stopped");
  command->callback([options, &exit_status] { exit_status = train(*options); });
}

}  // namespace roundabout::learning
