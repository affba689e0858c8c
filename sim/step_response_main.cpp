// step_response OUT [--config FILE]: measures the multirotor and draws OUT.svg and OUT.png.

#include <cstdio>

#include <CLI/CLI.hpp>

#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "sim/step_response_plot.h"

int main(int argc, char** argv) {
  std::string out;
  std::string config;
  CLI::App app("Measures and draws how the simulated multirotor answers steps.", "step_response");
  app.add_option("OUT", out, "Path of the figures, without extension")->required();
  app.add_option("--config", config, "Experiment file whose sim.multirotor is measured");
  CLI11_PARSE(app, argc, argv);
  try {
    const roundabout::config::Experiment experiment =
        config.empty() ? roundabout::config::Experiment{}
                       : roundabout::config::readExperiment(config);
    std::fputs(roundabout::sim::drawStepResponses(experiment.sim, out).c_str(), stdout);
  } catch (const roundabout::core::StartupError& error) {
    std::fprintf(stderr, "step_response: %s\n", error.what());
    return 2;
  }
  return 0;
}
