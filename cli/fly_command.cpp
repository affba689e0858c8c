#include "cli/fly_command.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "cli/console.h"
#include "cli/flight_folder.h"
#include "cli/flight_report.h"
#include "cli/supervisor.h"
#include "common/app/stop_signal.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/config/experiment_file.h"
#include "common/core/error.h"

namespace roundabout::cli {

namespace {

constexpr int kInterrupted = 130;
constexpr std::chrono::milliseconds kListen(150);

struct FlyOptions {
  std::string file;
  bool real_time = false;
  std::string policy;
  std::optional<std::uint64_t> seed;
  std::string folder;
  std::vector<std::string> overrides;
  std::string lcm_url;
  bool no_report = false;
};

// Files named on the command line are relative to the working directory; in an experiment file,
// to the file.
std::string withAbsoluteWeights(const std::string& policy) {
  const std::size_t colon = policy.find(':');
  if (colon == std::string::npos) {
    return policy;
  }
  return policy.substr(0, colon + 1) + std::filesystem::absolute(policy.substr(colon + 1)).string();
}

std::vector<std::string> allOverrides(const FlyOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (options.real_time) {
    overrides.emplace_back("sim.pacing=real_time");
  }
  if (!options.policy.empty()) {
    overrides.push_back("planner.policy=" + withAbsoluteWeights(options.policy));
  }
  if (options.seed) {
    overrides.push_back(fmt::format("seed={}", *options.seed));
  }
  return overrides;
}

// As it can be typed again, seed and policy spelled out.
std::string commandLine(const FlyOptions& options, const config::Experiment& experiment) {
  std::string line = fmt::format("./roundabout fly {} --policy {} --seed {}", options.file,
                                 experiment.planner.policy, experiment.seed);
  if (options.real_time) {
    line += " --real-time";
  }
  for (const std::string& override_text : options.overrides) {
    line += " --set '" + override_text + "'";
  }
  return line;
}

// Two flights on one URL would fly each other's vehicles.
void requireNobodyFlies(const std::string& lcm_url) {
  bus::LcmBus bus(lcm_url);
  bool somebody_flies = false;
  bus.subscribe(bus::kStatesChannel, [&](const bus::Received&) { somebody_flies = true; });
  const auto end = std::chrono::steady_clock::now() + kListen;
  while (!somebody_flies && std::chrono::steady_clock::now() < end) {
    bus.handle(std::chrono::milliseconds(20));
  }
  if (somebody_flies) {
    throw core::StartupError(lcm_url, bus::kStatesChannel,
                             "nobody publishing (a flight of its own on this URL)",
                             "states of another flight");
  }
}

int fly(const FlyOptions& options) {
  app::StopSignal stop;
  FlightPlan plan;
  plan.experiment = config::readExperiment(options.file, allOverrides(options));
  plan.lcm_url =
      bus::resolveUrl(options.lcm_url.empty() ? plan.experiment.lcm_url : options.lcm_url);
  plan.command_line = commandLine(options, plan.experiment);
  plan.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  requireNobodyFlies(plan.lcm_url);
  bus::LcmBus bus(plan.lcm_url);
  plan.folder = makeFlightFolder(plan.experiment, options.folder);

  Console console;
  console.say(fmt::format("{}: {} vehicles, {}, {}, seed {}", plan.experiment.name,
                          plan.experiment.vehicles.size(), plan.experiment.planner.policy,
                          plan.experiment.sim.pacing, plan.experiment.seed));
  const FlightResult result = Supervisor(plan, bus, stop, console).run();
  const bool good = reportFlight(plan, result, !options.no_report, console);
  if (result.interrupted) {
    return kInterrupted;
  }
  return good ? 0 : 1;
}

}  // namespace

void addFlyCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("fly", "Fly an experiment file");
  auto options = std::make_shared<FlyOptions>();
  command->add_option("file", options->file, "Experiment file (YAML)")->required();
  command->add_flag("--real-time", options->real_time, "As sim.pacing=real_time");
  command->add_option("--policy", options->policy, "NAME or NAME:WEIGHTS, as planner.policy");
  command->add_option("--seed", options->seed, "As seed");
  command->add_option("--out", options->folder,
                      "Folder for log and report (default: out/<experiment>-<time>)");
  command->add_option("--set", options->overrides, "Overrides a key of the experiment; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--lcm-url", options->lcm_url,
                      "Default: the experiment's, else LCM_DEFAULT_URL, else this machine only");
  command->add_flag("--no-report", options->no_report, "Leave only the log");
  command->callback([options, &exit_status] { exit_status = fly(*options); });
}

}  // namespace roundabout::cli
