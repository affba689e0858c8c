#include "logs/log_commands.h"

#include <memory>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "logs/figures/figures.h"
#include "logs/metrics/metrics_json.h"
#include "logs/metrics/metrics_text.h"
#include "logs/reading/channel_summary.h"
#include "logs/reading/event_log.h"
#include "logs/report/report.h"

namespace roundabout::logs {

namespace {

struct Options {
  std::string log_file;
  std::string experiment_file;
  std::string json_file;
  std::string folder;
};

void runInfo(const Options& options) { fmt::print("{}", describe(EventLog(options.log_file))); }

void runMetrics(const Options& options) {
  const Flight flight = readFlight(options.log_file, options.experiment_file);
  const Metrics metrics = computeMetrics(flight);
  fmt::print("{}", toText(flight, metrics));
  if (!options.json_file.empty()) {
    writeMetricsJson(metrics, options.json_file);
  }
}

void runPlot(const Options& options) {
  const Flight flight = readFlight(options.log_file, options.experiment_file);
  const Metrics metrics = computeMetrics(flight);
  const Figures figures = drawFlight(flight, metrics, options.folder);
  const std::string report = options.folder + "/report.html";
  writeReport(report, flight, metrics, figures, "");
  fmt::print("{} pictures and {}\n", figures.count(), report);
}

}  // namespace

void addLogCommands(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* log = app.add_subcommand("log", "Read, measure and draw the log of a flight");
  log->require_subcommand(1);
  const auto add = [&](const char* name, const char* description, void (*run)(const Options&)) {
    CLI::App* command = log->add_subcommand(name, description);
    command->add_option("log", options->log_file, "LCM event log")->required();
    command->callback([options, run] { run(*options); });
    return command;
  };
  const auto add_experiment = [&](CLI::App* command) {
    command->add_option(
        "--experiment", options->experiment_file,
        "Experiment file for radii and speeds; else experiment.yaml beside the log");
  };

  add("info", "What a log holds, channel by channel, and what is damaged", runInfo);

  CLI::App* metrics = add("metrics", "Separation, arrival, rates, faults", runMetrics);
  metrics->add_option("--json", options->json_file, "Also write everything to this file");
  add_experiment(metrics);

  CLI::App* plot = add("plot", "Pictures and a one-page report", runPlot);
  plot->add_option("-o,--out", options->folder, "Folder for the pictures")->required();
  add_experiment(plot);
}

}  // namespace roundabout::logs
