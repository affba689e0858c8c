#pragma once

// The one shape of every main: `return app::run<PlannerOptions>(argc, argv, runPlanner);`

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "common/app/stop_signal.h"
#include "common/config/experiment.h"

namespace roundabout::app {

/// What every program has after start-up.
struct Context {
  config::Experiment experiment;  ///< from --config, with every --set applied
  /// --lcm-url, else the experiment's, else LCM_DEFAULT_URL, else LCM's default
  std::string lcm_url;
  StopSignal& stop;
};

/// What tells one program from another.
struct Program {
  std::string name;
  std::string description;
  std::function<void(CLI::App&)> add_options;
  std::function<std::string()> label;  ///< of log lines, after parsing
  std::function<int(Context&)> body;
};

/// Parses --config, --set key=value (repeatable), --print-config, --lcm-url, --verbose, --help and
/// what add_options adds; reads the experiment; sets up spdlog (lines begin with the program's
/// label; to stderr); ignores SIGPIPE; calls body. --print-config writes the experiment with all
/// defaults to stdout instead. Exit status: body's; 2 after a core::StartupError or wrong
/// arguments, with one line on stderr; 1 after any other exception.
int runProgram(int argc, const char* const* argv, const Program& program);

/// Options is a struct with kName, kDescription and addOptions(CLI::App&), holding what is the
/// program's own. If it has a label() that says more than kName ("planner:hex1"), log lines begin
/// with that.
template <class Options>
int run(int argc, const char* const* argv, int (*program)(const Options&, Context&)) {
  Options options;
  return runProgram(argc, argv,
                    {Options::kName, Options::kDescription,
                     [&options](CLI::App& app) { options.addOptions(app); },
                     [&options]() -> std::string {
                       if constexpr (requires { options.label(); }) {
                         return options.label();
                       } else {
                         return Options::kName;
                       }
                     },
                     [&options, program](Context& context) { return program(options, context); }});
}

}  // namespace roundabout::app
