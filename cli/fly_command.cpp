#include "cli/fly_command.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "cli/console.h"
#include "cli/emulation.h"
#include "cli/flight_folder.h"
#include "cli/flight_report.h"
#include "cli/nobody_flies.h"
#include "cli/supervisor.h"
#include "common/app/stop_signal.h"
#include "common/bus/lcm_bus.h"
#include "common/config/experiment_file.h"
#include "common/config/keys.h"

namespace roundabout::cli {

namespace {

constexpr int kInterrupted = 130;

struct FlyOptions {
  std::string file;
  bool real_time = false;
  std::string mocap;  ///< protocol of an emulated motion-capture system
  std::string policy;
  std::optional<std::uint64_t> seed;
  std::string shield;  // on or off; empty: as the file says
  std::string folder;
  std::vector<std::string> overrides;
  std::string lcm_url;
  bool no_report = false;
};

std::vector<std::string> allOverrides(const FlyOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (!options.mocap.empty()) {
    const std::vector<std::string> emulation = emulationOverrides(options.mocap);
    overrides.insert(overrides.end(), emulation.begin(), emulation.end());
  }
  if (options.real_time || !options.mocap.empty()) {
    overrides.emplace_back("sim.pacing=real_time");
  }
  if (!options.policy.empty()) {
    overrides.push_back("planner.policy=" + options.policy);
  }
  if (!options.shield.empty()) {
    overrides.push_back(fmt::format("shield.on={}", options.shield == "on"));
  }
  if (options.seed) {
    overrides.push_back(fmt::format("seed={}", *options.seed));
  }
  return overrides;
}

// As it can be typed again, seed and policy spelled out.
std::string commandLine(const FlyOptions& options, const config::Experiment& experiment) {
  std::string line =
      fmt::format("./roundabout fly {} --policy {} --seed {} --shield {}", options.file,
                  experiment.planner.policy, experiment.seed, experiment.shield.on ? "on" : "off");
  if (options.real_time) {
    line += " --real-time";
  }
  if (!options.mocap.empty()) {
    line += " --mocap " + options.mocap;
  }
  for (const std::string& override_text : options.overrides) {
    line += " --set '" + override_text + "'";
  }
  return line;
}

FlightPlan planOf(const FlyOptions& options) {
  FlightPlan plan;
  plan.experiment = config::readExperiment(options.file, allOverrides(options));
  plan.lcm_url =
      bus::resolveUrl(options.lcm_url.empty() ? plan.experiment.lcm_url : options.lcm_url);
  plan.emulate_mocap = !options.mocap.empty();
  plan.command_line = commandLine(options, plan.experiment);
  plan.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return plan;
}

// Where the states come from, for the first line.
std::string statesOf(const FlightPlan& plan) {
  if (plan.emulate_mocap) {
    return "real_time through emulated " + plan.experiment.source;
  }
  return plan.experiment.source == "sim" ? plan.experiment.sim.pacing : plan.experiment.source;
}

FlightResult superviseFlight(FlightPlan& plan, const FlyOptions& options, Console& console) {
  app::StopSignal stop;
  requireNobodyFlies(plan.experiment, plan.lcm_url);
  bus::LcmBus bus(plan.lcm_url);
  plan.folder = makeFlightFolder(plan.experiment, options.folder);
  console.say(fmt::format("{}: {} vehicles, {} {} shield, {}, seed {}", plan.experiment.name,
                          plan.experiment.vehicles.size(), plan.experiment.planner.policy,
                          plan.experiment.shield.on ? "behind a" : "without a", statesOf(plan),
                          plan.experiment.seed));
  return Supervisor(plan, bus, stop, console).run();
}

int fly(const FlyOptions& options) {
  standWithoutTerminal();
  FlightPlan plan = planOf(options);
  Console console;
  const FlightResult result = superviseFlight(plan, options, console);
  // Nothing flies any more: from here on Ctrl-C ends the program, as it does any other.
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
  command
      ->add_option(
          "--mocap", options->mocap,
          "Simulated vehicles are seen through this emulated motion-capture system, in real "
          "time")
      ->check(CLI::IsMember(std::vector<std::string>(config::kMocapProtocols)));
  command->add_option("--policy", options->policy, "NAME or NAME:WEIGHTS, as planner.policy");
  command->add_option("--seed", options->seed, "As seed");
  command->add_option("--shield", options->shield, "As shield.on")
      ->check(CLI::IsMember({"on", "off"}));
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
