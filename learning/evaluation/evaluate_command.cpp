#include "learning/evaluation/evaluate_command.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <thread>

#include <spdlog/fmt/fmt.h>

#include "common/app/stop_signal.h"
#include "common/config/obstacles.h"
#include "common/config/words.h"
#include "common/core/error.h"
#include "learning/evaluation/case_file.h"
#include "learning/evaluation/figures.h"
#include "learning/evaluation/generate.h"
#include "learning/evaluation/obstacle_course.h"
#include "learning/evaluation/progress_line.h"
#include "learning/evaluation/results_folder.h"
#include "learning/evaluation/run_description.h"
#include "learning/evaluation/summary.h"
#include "planner/policies/table.h"

namespace roundabout::learning {

namespace {

constexpr int kInterrupted = 130;
constexpr const char* kDefaultPolicy = "ga3c_cadrl";

struct Options {
  std::vector<std::string> policies;
  std::string suite;
  std::string case_file;
  std::string generate;
  std::string obstacle_file;
  GeneratorSettings generator;
  std::optional<double> half_side_m;
  int count = 100;
  std::uint64_t seed = 1;
  std::string rules = "published";
  std::optional<double> loss;
  double slower = 1.0;
  std::string mix;
  double mix_share = 0.5;
  bool mix_unshielded = false;
  std::string shield = "both";
  std::string folder;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool resume = false;
  bool list = false;
  std::vector<int> draw;
  std::optional<int> animate;
  bool no_figures = false;
};

void list() {
  fmt::print("policies\n");
  for (const planner::PolicyEntry& entry : planner::policyTable()) {
    fmt::print("  {}{}\n", entry.name,
               !entry.has_weights              ? ""
               : entry.shipped_weights.empty() ? ":WEIGHTS"
                                               : "[:WEIGHTS]");
  }
  fmt::print("suites\n");
  for (const SuiteEntry& entry : suiteTable()) {
    fmt::print("  {:<11} {}\n", entry.name, entry.description);
  }
  fmt::print("kinds of generated cases\n  {}\n", fmt::join(generatorKinds(), ", "));
  for (const std::string_view name : rulesNames()) {
    fmt::print("rules {}\n", name);
    for (const std::string& sentence : makeRules(std::string(name)).sentences()) {
      fmt::print("  - {}\n", sentence);
    }
  }
}

Contestant makeContestant(const std::string& specification, const Rules& rules,
                          const std::string& where) {
  planner::PolicyOptions options;
  options.orca = rules.orca;
  options.with_value = false;
  options.where = where;
  return {specification, planner::makePolicy(specification, options), false};
}

void requireOrder(const char* option, double min, double max) {
  if (min > max) {
    throw core::StartupError("evaluate", option, "MIN MAX", fmt::format("{} {}", min, max));
  }
}

Suite generated(const Options& options) {
  GeneratorSettings settings = options.generator;
  settings.half_side_m = options.half_side_m.value_or(publishedHalfSide(settings.agents));
  requireOrder("--radius", settings.min_radius_m, settings.max_radius_m);
  requireOrder("--speed", settings.min_speed_mps, settings.max_speed_mps);
  if (!options.obstacle_file.empty()) {
    settings.obstacles = config::outlinesOf(config::readObstacles(options.obstacle_file));
  }
  const std::string agents = agentsText(static_cast<std::size_t>(settings.agents));
  return {fmt::format("{}, {}, seed {}", options.generate, agents, options.seed),
          {{agents, generateCases(options.generate, settings, options.count, options.seed)}},
          {}};
}

Suite casesOf(const Options& options) {
  if (!options.generate.empty()) {
    return generated(options);
  }
  Suite suite = options.suite.empty()
                    ? Suite{std::filesystem::path(options.case_file).stem().string(),
                            readCaseFile(options.case_file),
                            {}}
                    : makeSuite(options.suite);
  if (!options.obstacle_file.empty()) {
    addObstacles(suite, options.obstacle_file);
  }
  return suite;
}

/// Of the cases to draw and to animate.
void checkNumbers(const Options& options, const Suite& suite) {
  std::size_t most = 0;
  for (const CaseGroup& group : suite.groups) {
    most = std::max(most, group.cases.size());
  }
  const auto check = [](const char* option, int number, std::size_t cases) {
    if (static_cast<std::size_t>(number) >= cases) {
      throw core::StartupError("evaluate", option, fmt::format("a case from 0 to {}", cases - 1),
                               fmt::format("{}", number));
    }
  };
  for (const int number : options.draw) {
    check("--draw", number, most);
  }
  if (options.animate) {
    check("--animate", *options.animate, suite.groups.front().cases.size());
  }
}

Evaluation prepare(const Options& options) {
  const int sources = static_cast<int>(!options.suite.empty()) +
                      static_cast<int>(!options.case_file.empty()) +
                      static_cast<int>(!options.generate.empty());
  if (sources != 1) {
    throw core::StartupError("evaluate", "cases", "one of --suite, --cases, --generate",
                             sources == 0 ? "none" : "several");
  }
  if (options.folder.empty()) {
    throw core::StartupError("evaluate", "--out", "a folder", "none");
  }
  Evaluation evaluation;
  evaluation.rules = makeRules(options.rules);
  if ((options.loss || options.slower != 1.0) && !evaluation.rules.lab) {
    throw core::StartupError("evaluate", "--loss, --slower", "--rules lab", options.rules);
  }
  evaluation.rules.loss = options.loss.value_or(evaluation.rules.loss);
  slowDown(evaluation.rules, options.slower);
  for (const std::string& specification : options.policies) {
    for (const bool shielded : {false, true}) {
      if (options.shield == "both" || shielded == (options.shield == "on")) {
        evaluation.contestants.push_back(
            makeContestant(specification, evaluation.rules, "--policy"));
        evaluation.contestants.back().shielded = shielded;
      }
    }
  }
  if (!options.mix.empty()) {
    evaluation.mix.emplace(Mix{makeContestant(options.mix, evaluation.rules, "--mix"),
                               options.mix_share, !options.mix_unshielded, options.seed});
  }
  evaluation.suite = casesOf(options);
  checkObstacles(evaluation);
  checkNumbers(options, evaluation.suite);
  evaluation.rules.goal_distance_m =
      evaluation.suite.goal_distance_m.value_or(evaluation.rules.goal_distance_m);
  return evaluation;
}

void writeSummary(const Evaluation& evaluation, const ResultsFolder& results, double wall_s,
                  long decisions) {
  const std::vector<Score> scores = scoresOf(evaluation, results.finished());
  const std::string text = summaryText(evaluation, scores);
  std::ofstream(results.path() / "summary.txt") << text;
  std::ofstream(results.path() / "summary.json") << summaryJson(evaluation, scores).dump(2) << '\n';
  fmt::print("{}", text);
  if (decisions > 0) {
    fmt::print("\n{} agent-steps in {:.2f} s: {:.0f} a second\n", decisions, wall_s,
               static_cast<double>(decisions) / wall_s);
  }
  fmt::print("{}\n", results.path().string());
}

/// Rows of the cases that were asked for by number, for every contestant.
std::vector<std::size_t> rowsToDraw(const Options& options, const Evaluation& evaluation) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < evaluation.cases(); ++row) {
    const Place place = placeOf(evaluation, row);
    if (std::find(options.draw.begin(), options.draw.end(), static_cast<int>(place.number)) !=
        options.draw.end()) {
      rows.push_back(row);
    }
  }
  return rows;
}

void drawAll(const Options& options, const Evaluation& evaluation, const ResultsFolder& results) {
  drawComparison(evaluation, scoresOf(evaluation, results.finished()), results.path());
  const std::vector<std::size_t> rows = rowsToDraw(options, evaluation);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string file = drawTrajectories(evaluation, rows[i], results.path());
    fmt::print(stderr, "drawn {} of {}: {}\n", i + 1, rows.size(), file);
  }
  if (options.animate) {
    for (std::size_t row = 0; row < evaluation.cases(); ++row) {
      const Place place = placeOf(evaluation, row);
      if (place.group == 0 && place.number == static_cast<std::size_t>(*options.animate)) {
        fmt::print(stderr, "animated: {}\n", animate(evaluation, row, results.path()));
      }
    }
  }
}

int evaluate(Options options) {
  if (options.list) {
    list();
    return 0;
  }
  if (options.policies.empty()) {
    options.policies = {kDefaultPolicy};
  }
  app::StopSignal stop;
  const Evaluation evaluation = prepare(options);
  ResultsFolder results(options.folder, describeRun(evaluation), options.resume, evaluation);

  ProgressLine progress(results.finished().size(), evaluation.cases(), "cases");
  long decisions = 0;
  const auto began = std::chrono::steady_clock::now();
  const bool whole = runAll(
      evaluation, results.finished().size(), options.threads,
      [&](std::size_t row, const EpisodeResult& result) {
        results.append(evaluation, row, result);
        decisions += result.decisions;
        const Place place = placeOf(evaluation, row);
        progress.show(row + 1, labelOf(evaluation, place.contestant));
      },
      [&] { return !stop.requested(); });
  if (!whole) {
    fmt::print(stderr, "\nstopped after {} of {} cases; go on with --resume\n",
               results.finished().size(), evaluation.cases());
    return kInterrupted;
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - began;
  writeSummary(evaluation, results, wall.count(), decisions);
  if (!options.no_figures) {
    drawAll(options, evaluation, results);
  }
  return 0;
}

}  // namespace

void addEvaluateCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("evaluate", "Run policies on the same test cases");
  auto options = std::make_shared<Options>();
  command
      ->add_option("--policy", options->policies,
                   "NAME or NAME:WEIGHTS; repeatable. Default: ga3c_cadrl")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--suite", options->suite, "Cases by name (--list)");
  command->add_option("--cases", options->case_file, "Cases from a CSV file");
  command->add_option("--generate", options->generate, "Generated cases of this kind (--list)");
  command->add_option("--obstacles", options->obstacle_file,
                      "YAML file of obstacles that stand in every case");
  command->add_option("--agents", options->generator.agents, "In each generated case")
      ->check(CLI::Range(1, 1000));
  command->add_option("--count", options->count, "Generated cases")->check(CLI::Range(1, 1000000));
  command
      ->add_option(
          "--half-side", options->half_side_m,
          "m; generated places lie in a square of twice this. Default: 4, from ten agents 6")
      ->check(CLI::Range(0.1, 1000.0));
  command->add_option("--radius", "MIN MAX, m, of generated agents")
      ->expected(2)
      ->check(CLI::Range(0.01, 100.0))
      ->each([options, first = true](const std::string& text) mutable {
        (first ? options->generator.min_radius_m : options->generator.max_radius_m) =
            std::stod(text);
        first = false;
      });
  command->add_option("--speed", "MIN MAX, m/s, preferred by generated agents")
      ->expected(2)
      ->check(CLI::Range(0.05, 100.0))
      ->each([options, first = true](const std::string& text) mutable {
        (first ? options->generator.min_speed_mps : options->generator.max_speed_mps) =
            std::stod(text);
        first = false;
      });
  command->add_option("--seed", options->seed, "Of generated cases and of --mix");
  command->add_option("--rules", options->rules, "published or lab (--list)");
  command->add_option("--loss", options->loss, "Share of messages lost in the lab; default: 0.05")
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--slower", options->slower,
                   "Lag and delay in the lab, times what the shield assumes; default: 1")
      ->check(CLI::Range(0.1, 10.0));
  command->add_option("--mix", options->mix, "NAME or NAME:WEIGHTS that some agents run instead");
  command->add_option("--mix-share", options->mix_share, "How many of them, 0 to 1")
      ->check(CLI::Range(0.0, 1.0));
  command->add_flag("--mix-unshielded", options->mix_unshielded,
                    "They fly without the shield in any case");
  command->add_option("--shield", options->shield, "on, off or both; default: both")
      ->check(CLI::IsMember({"on", "off", "both"}));
  command->add_option("--out", options->folder, "Folder for the results");
  command->add_option("--threads", options->threads, "Default: one a core")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--resume", options->resume, "Go on where the same command was interrupted");
  command->add_option("--draw", options->draw, "Draw the trajectories of these cases of each group")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  command->add_option("--animate", options->animate, "Animate this case of the first group (GIF)")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--no-figures", options->no_figures, "Leave only numbers");
  command->add_flag("--list", options->list, "Show policies, suites, kinds and rules");
  command->callback([options, &exit_status] { exit_status = evaluate(*options); });
}

}  // namespace roundabout::learning
