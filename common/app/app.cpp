#include "common/app/app.h"

#include <csignal>
#include <exception>
#include <iostream>
#include <vector>

#include "common/app/log.h"
#include "common/bus/lcm_bus.h"
#include "common/config/experiment_file.h"
#include "common/core/error.h"

namespace roundabout::app {

namespace {

constexpr int kFailed = 1;
constexpr int kNotStarted = 2;

struct CommonOptions {
  std::string config;
  std::vector<std::string> overrides;
  bool print_config = false;
  std::string lcm_url;
  bool verbose = false;

  void addTo(CLI::App& app) {
    app.add_option("--config", config, "Experiment file")->required()->type_name("FILE");
    app.add_option("--set", overrides, "Overrides a key of the experiment file; repeatable")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false)
        ->take_all();
    app.add_flag("--print-config", print_config, "Prints the experiment, defaults included");
    app.add_option("--lcm-url", lcm_url, "Instead of the experiment's lcm_url")->type_name("URL");
    app.add_flag("--verbose", verbose, "Logs more");
  }
};

}  // namespace

int runProgram(int argc, const char* const* argv, const Program& program) {
  CommonOptions options;
  CLI::App parser(program.description, program.name);
  std::string label = program.name;
  try {
    // Before anything can start a thread.
    StopSignal stop;
    std::signal(SIGPIPE, SIG_IGN);
    options.addTo(parser);
    program.add_options(parser);
    parser.parse(argc, argv);
    label = program.label();
    setUpLog(label, options.verbose);
    config::Experiment experiment = config::readExperiment(options.config, options.overrides);
    if (options.print_config) {
      std::cout << config::toYaml(experiment);
      return 0;
    }
    std::string url =
        bus::resolveUrl(options.lcm_url.empty() ? experiment.lcm_url : options.lcm_url);
    Context context{std::move(experiment), std::move(url), stop};
    return program.body(context);
  } catch (const CLI::Success& help) {
    return parser.exit(help);
  } catch (const CLI::ParseError& error) {
    std::cerr << label << ": " << error.what() << " (try --help)\n";
    return kNotStarted;
  } catch (const core::StartupError& error) {
    std::cerr << label << ": " << error.what() << '\n';
    return kNotStarted;
  } catch (const std::exception& error) {
    std::cerr << label << ": " << error.what() << '\n';
    return kFailed;
  }
}

}  // namespace roundabout::app
