#pragma once

// The one shape of every main: `return app::run<PlannerOptions>(argc, argv, runPlanner);`

#include <functional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "common/app/stop_signal.h"
#include "common/config/experiment.h"

namespace roundabout::app {

/// What every program has after start-up.
struct Context {
  config::Experiment experiment;  ///< from --config, with every --set applied
  std::string
      lcm_url;  ///< --lcm-url, else the experiment's, else LCM_DEFAULT_URL, else LCM's default
  StopSignal& stop;
};

/// Parses --config, --set key=value (repeatable), --print-config, --lcm-url, --verbose, --help and
/// what add_options adds; reads the experiment; sets up spdlog (lines begin with the program's
/// label; to stderr); calls body. Exit status: body's; 2 after a core::StartupError or wrong
/// arguments, with one line on stderr; 1 after any other exception.
int runProgram(int argc, char** argv, std::string_view name, std::string_view description,
               const std::function<void(CLI::App&)>& add_options,
               const std::function<int(Context&)>& body);

/// Options is a struct with kName, kDescription and addOptions(CLI::App&), holding what is the
/// program's own.
template <class Options>
int run(int argc, char** argv, int (*program)(const Options&, Context&)) {
  Options options;
  return runProgram(
      argc, argv, Options::kName, Options::kDescription,
      [&options](CLI::App& app) { options.addOptions(app); },
      [&options, program](Context& context) { return program(options, context); });
}

}  // namespace roundabout::app
