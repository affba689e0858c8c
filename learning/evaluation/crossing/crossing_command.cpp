#include "learning/evaluation/crossing/crossing_command.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "common/plot/gnuplot_script.h"
#include "learning/evaluation/crossing/crossing_figure.h"
#include "learning/evaluation/progress_line.h"
#include "learning/training/workers.h"
#include "planner/policies/table.h"
#include "sim/pedestrians/policy_steering.h"
#include "sim/pedestrians/recording.h"

namespace roundabout::learning {

namespace {

struct Options {
  std::string file;
  int runs = 100;
  std::vector<std::string> policies;
  std::string shield = "on";
  std::string eyes = "perception";
  std::vector<std::string> overrides;
  std::string csv;
  std::vector<int> only;
  std::string pictures;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

struct Variant {
  std::string policy;
  std::string label;  ///< of the table and of pictures; policies differ by it
  bool shield;
};

/// Run k of a variant: seed k, or with a recording the k-th of start times spread over it.
config::Experiment experimentOf(const Options& options, const Variant& variant, int run) {
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back("planner.policy=" + variant.policy);
  overrides.push_back(fmt::format("shield.on={}", variant.shield));
  overrides.push_back(fmt::format("seed={}", run + 1));
  config::Experiment experiment = config::readExperiment(options.file, overrides);
  config::Recording& recording = experiment.pedestrians.recording;
  if (!recording.file.empty()) {
    const double all_s = sim::RecordedPeople(recording, experiment.file).durationS();
    const double last_s = std::max(0.0, all_s - experiment.fleet.step_timeout_s);
    recording.start_s = last_s * run / std::max(1, options.runs - 1);
  }
  return experiment;
}

CrossingCast castOf(const Options& options, const config::Experiment& experiment) {
  planner::PolicyOptions policy;
  policy.orca = experiment.planner.orca;
  policy.where = experiment.file;
  policy.with_value = false;
  return {options.eyes == "truth" ? trueEyes : perceptionEyes,
          [specification = experiment.planner.policy, policy] {
            return planner::makePolicy(specification, policy);
          },
          sim::steeringFor(experiment)};
}

void writeRows(std::ofstream& csv, const Variant& variant, const std::vector<int>& runs,
               const std::vector<CrossingResult>& results) {
  for (std::size_t i = 0; i < results.size(); ++i) {
    const CrossingResult& each = results[i];
    const sim::Encounter met = each.first_collision.value_or(sim::Encounter{});
    csv << fmt::format(
        "{},{},{},{},{:.2f},{:.2f},{:.3f},{},{},{},{},{},{},{:.2f},{:.2f},{:.2f},{:.3f}\n",
        variant.policy, variant.shield ? "on" : "off", runs[i] + 1, each.reached ? 1 : 0,
        each.time_s, each.extra_time_s, each.closest_m, each.collisions_by_robot,
        each.collisions_by_person, each.collisions_with_things, each.ticks, each.ticks_blind,
        each.ticks_shielded, each.first_collision_s, met.vehicle_closing_mps,
        met.person_closing_mps, each.off_goal_m);
  }
  csv.flush();
}

void printHead() {
  fmt::print("{:<24} {:<6} {:>5} {:>8} {:>9} {:>9} {:>7} {:>8} {:>8} {:>8} {:>8} {:>6} {:>8}\n",
             "policy", "shield", "runs", "reached", "by robot", "by person", "things", "closest",
             "median", "extra s", "p90 s", "blind", "shielded");
}

void print(const Variant& variant, const CrossingSummary& summary) {
  fmt::print(
      "{:<24} {:<6} {:>5} {:>8} {:>9} {:>9} {:>7} {:>8.3f} {:>8.3f} {:>8.2f} {:>8.2f} "
      "{:>5.1f}% {:>7.1f}%\n",
      variant.label, variant.shield ? "on" : "off", summary.runs, summary.reached,
      summary.runs_hit_by_robot, summary.runs_hit_by_person, summary.runs_hit_things,
      summary.closest_m, summary.median_closest_m, summary.mean_extra_s, summary.p90_extra_s,
      100.0 * summary.blind_share, 100.0 * summary.shielded_share);
}

/// The file name of weights or the name of a policy; with the whole path where two would be alike.
std::string labelOf(const std::string& policy, const std::vector<std::string>& policies) {
  const auto fileNameOf = [](const std::string& each) {
    return std::filesystem::path(each.substr(each.find(':') + 1)).filename().string();
  };
  const bool alike = std::any_of(policies.begin(), policies.end(), [&](const std::string& other) {
    return other != policy && fileNameOf(other) == fileNameOf(policy);
  });
  std::string label = alike ? policy : fileNameOf(policy);
  std::replace(label.begin(), label.end(), '/', '_');
  return label;
}

std::vector<Variant> variantsOf(const Options& options) {
  std::vector<std::string> policies = options.policies;
  if (policies.empty()) {
    policies.push_back(config::readExperiment(options.file, options.overrides).planner.policy);
  }
  std::vector<Variant> variants;
  for (const std::string& policy : policies) {
    for (const bool shield : {true, false}) {
      if (options.shield == "both" || (options.shield == "on") == shield) {
        variants.push_back({policy, labelOf(policy, policies), shield});
      }
    }
  }
  return variants;
}

std::ofstream csvFile(const std::string& path) {
  std::ofstream csv;
  if (!path.empty()) {
    csv.open(path);
    if (!csv) {
      throw core::StartupError("cross", "--csv", "a file that can be written", path);
    }
    csv << "policy,shield,run,reached,time_s,extra_s,closest_m,by_robot,by_person,things,ticks,"
           "blind,shielded,met_s,robot_towards_mps,person_towards_mps,off_goal_m\n";
  }
  return csv;
}

/// So that nobody waits for runs whose pictures cannot be drawn.
void preparePictures(const std::string& folder) {
  if (folder.empty()) {
    return;
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder, error) || ::access(folder.c_str(), W_OK) != 0) {
    throw core::StartupError("cross", "--pictures", "a folder that can be written to", folder);
  }
  plot::GnuplotScript().run();
}

/// Counted from 0: those asked for, else all.
std::vector<int> runsOf(const Options& options) {
  std::vector<int> runs;
  for (const int run : options.only) {
    if (run > options.runs) {
      throw core::StartupError("cross", "--only", fmt::format("1 to --runs {}", options.runs),
                               std::to_string(run));
    }
    runs.push_back(run - 1);
  }
  if (runs.empty()) {
    runs.resize(static_cast<std::size_t>(options.runs));
    std::iota(runs.begin(), runs.end(), 0);
  }
  return runs;
}

/// Those asked for by number; else the first, the slowest, and some with a collision.
std::vector<std::size_t> drawn(const Options& options, const std::vector<CrossingResult>& results) {
  constexpr std::size_t kMostPictures = 6;
  std::set<std::size_t> chosen;
  if (!options.only.empty()) {
    for (std::size_t i = 0; i < results.size(); ++i) {
      chosen.insert(i);
    }
  } else {
    chosen.insert(0);
    const auto slowest = std::max_element(
        results.begin(), results.end(),
        [](const CrossingResult& a, const CrossingResult& b) { return a.time_s < b.time_s; });
    chosen.insert(static_cast<std::size_t>(slowest - results.begin()));
    for (std::size_t i = 0; i < results.size() && chosen.size() < kMostPictures; ++i) {
      if (results[i].first_collision) {
        chosen.insert(i);
      }
    }
  }
  return {chosen.begin(), chosen.end()};
}

std::string whatHappened(const CrossingResult& result) {
  std::string text = result.reached ? fmt::format("goal after {:.1f} s", result.time_s)
                                    : fmt::format("not there after {:.0f} s", result.time_s);
  if (result.first_collision) {
    text += result.first_collision->byVehicle() ? ", ran into somebody" : ", was walked into";
  }
  return text;
}

void draw(const Options& options, const Variant& variant, const std::vector<int>& runs,
          const std::vector<CrossingResult>& results) {
  for (const std::size_t i : drawn(options, results)) {
    const config::Experiment experiment = experimentOf(options, variant, runs[i]);
    CrossingTrace trace;
    const CrossingResult result = runCrossing(experiment, castOf(options, experiment), &trace);
    const std::string name = fmt::format("{}_{}_{}", variant.label,
                                         variant.shield ? "shield" : "no_shield", runs[i] + 1);
    const std::filesystem::path file = std::filesystem::path(options.pictures) / name;
    drawCrossing(experiment, trace,
                 fmt::format("{}{}, run {}: {}", variant.label, variant.shield ? " + shield" : "",
                             runs[i] + 1, whatHappened(result)),
                 file);
    fmt::print(stderr, "drawn: {}.png\n", file.string());
  }
}

int cross(const Options& options) {
  const std::vector<int> runs = runsOf(options);
  const std::vector<Variant> variants = variantsOf(options);
  for (const Variant& variant : variants) {
    const config::Experiment experiment = experimentOf(options, variant, runs.front());
    requireCrossing(experiment, castOf(options, experiment));
  }
  preparePictures(options.pictures);
  std::ofstream csv = csvFile(options.csv);
  Workers workers(options.threads);
  fmt::print(
      "{}: {} runs each, eyes: {}; columns by robot, by person, things: runs with a "
      "collision\n",
      options.file, runs.size(), options.eyes);
  printHead();
  std::fflush(stdout);
  ProgressLine progress(0, variants.size() * runs.size(), "runs");
  std::size_t done = 0;
  std::mutex one_at_a_time;
  for (const Variant& variant : variants) {
    std::vector<CrossingResult> results(runs.size());
    workers.forEach(static_cast<int>(runs.size()), [&](int i) {
      const auto at = static_cast<std::size_t>(i);
      const config::Experiment experiment = experimentOf(options, variant, runs[at]);
      results[at] = runCrossing(experiment, castOf(options, experiment));
      const std::lock_guard lock(one_at_a_time);
      progress.show(++done, variant.label);
    });
    progress.hide();
    print(variant, summarise(results));
    std::fflush(stdout);
    if (csv.is_open()) {
      writeRows(csv, variant, runs, results);
    }
    if (!options.pictures.empty()) {
      draw(options, variant, runs, results);
    }
  }
  return 0;
}

}  // namespace

void addCrossCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand(
      "cross", "Drive a robot through an experiment's pedestrians many times, without wires");
  auto options = std::make_shared<Options>();
  command->add_option("file", options->file, "Experiment file (YAML)")->required();
  command
      ->add_option("--runs", options->runs,
                   "Seeds 1 to N; with recorded people, N start times spread over the recording")
      ->check(CLI::PositiveNumber);
  command->add_option("--policy", options->policies,
                      "NAME or NAME:WEIGHTS; repeatable (default: the experiment's)");
  command->add_option("--shield", options->shield, "on (default), off or both")
      ->check(CLI::IsMember({"on", "off", "both"}));
  command
      ->add_option("--eyes", options->eyes,
                   "perception: tracks from the lidar; truth: everybody in range, exactly")
      ->check(CLI::IsMember({"perception", "truth"}));
  command->add_option("--set", options->overrides, "Overrides a key of the experiment; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--csv", options->csv, "A line for every run");
  command
      ->add_option("--only", options->only,
                   "Only this one of the N runs, to see it again; repeatable")
      ->check(CLI::PositiveNumber);
  command->add_option("--pictures", options->pictures,
                      "A folder for pictures: of the runs of --only, else of the first, the "
                      "slowest, and some with a collision");
  command->add_option("--threads", options->threads)->check(CLI::PositiveNumber);
  command->callback([options, &exit_status] { exit_status = cross(*options); });
}

}  // namespace roundabout::learning
