#include "logs/log_commands.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"
#include "logs/compare/compare.h"
#include "logs/export/csv.h"
#include "logs/export/cut.h"
#include "logs/export/mcap.h"
#include "logs/figures/figures.h"
#include "logs/files.h"
#include "logs/metrics/metrics_json.h"
#include "logs/metrics/metrics_text.h"
#include "logs/reading/channel_summary.h"
#include "logs/reading/event_log.h"
#include "logs/report/report.h"
#include "logs/types/type_table.h"

namespace roundabout::logs {

namespace {

struct Options {
  std::string log_file;
  std::string other_log_file;
  std::string experiment_file;
  std::string json_file;
  std::string out;
  std::vector<std::string> types;
  bool data_clock = false;
  double tolerance_m = 0.01;
  CutOptions cut;
};

/// "flights/tuesday.lcm" and ".mcap": "tuesday.mcap", in the working folder.
std::string outputFor(const Options& options, const std::string& ending) {
  return options.out.empty() ? std::filesystem::path(options.log_file).stem().string() + ending
                             : options.out;
}

void runInfo(const Options& options) {
  fmt::print("{}", describe(EventLog(options.log_file), TypeTable(options.types)));
}

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
  const Figures figures = drawFlight(flight, metrics, options.out);
  const std::string report = options.out + "/report.html";
  writeReport(report, flight, metrics, figures, "");
  fmt::print("{} pictures and {}\n", figures.count(), report);
}

/// A folder that is gone afterwards.
class PictureFolder {
 public:
  PictureFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "roundabout-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw core::StartupError(name, "pictures", "a temporary folder", "none");
    }
    path_ = name;
  }
  ~PictureFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void runReport(const Options& options) {
  const Flight flight = readFlight(options.log_file, options.experiment_file);
  const Metrics metrics = computeMetrics(flight);
  const PictureFolder pictures;
  const Figures figures = drawFlight(flight, metrics, pictures.path());
  const std::string file = outputFor(options, ".html");
  writeReport(file, flight, metrics, figures, "");
  fmt::print("{}\n", file);
}

void runCsv(const Options& options) {
  const std::string folder = outputFor(options, "_csv");
  makeFolder(folder);
  std::vector<CsvFile> files =
      writeChannelTables(EventLog(options.log_file), TypeTable(options.types), folder);
  const Flight flight = readFlight(options.log_file, options.experiment_file);
  files.push_back(
      writeVehicleTable(flight, (std::filesystem::path(folder) / "vehicles.csv").string()));
  for (const CsvFile& file : files) {
    if (file.file.empty()) {
      fmt::print("{}: not written, {}\n", file.channel, file.problem);
    } else {
      fmt::print("{}: {} rows{}\n", file.file, file.rows,
                 file.rejected == 0 ? "" : fmt::format(", {} messages of no use", file.rejected));
    }
  }
}

void runMcap(const Options& options) {
  const std::string file = outputFor(options, ".mcap");
  const McapResult result =
      writeMcap(EventLog(options.log_file), TypeTable(options.types),
                options.data_clock ? McapClock::kData : McapClock::kLog, file);
  fmt::print("{}: {} messages, {} of them as raw bytes of unknown types, {} could not be decoded\n",
             file, result.messages, result.raw, result.rejected);
}

void runCut(const Options& options) {
  const std::size_t events = cutLog(EventLog(options.log_file), options.cut, options.out);
  fmt::print("{}: {} events\n", options.out, events);
}

void runCompare(const Options& options) {
  const Flight a = readFlight(options.log_file, options.experiment_file);
  const Flight b = readFlight(options.other_log_file, options.experiment_file);
  fmt::print("{}", toText(compareFlights(a, b, options.tolerance_m), options.tolerance_m));
}

class Commands {
 public:
  Commands(CLI::App& app, std::shared_ptr<Options> options)
      : log_(*app.add_subcommand("log", "Read, measure, draw and convert the log of a flight")),
        options_(std::move(options)) {
    log_.require_subcommand(1);
  }

  CLI::App* add(const char* name, const char* description, void (*run)(const Options&)) {
    CLI::App* command = log_.add_subcommand(name, description);
    command->add_option("log", options_->log_file, "LCM event log")->required();
    command->callback([options = options_, run] { run(*options); });
    return command;
  }
  void experiment(CLI::App* command) {
    command->add_option(
        "--experiment", options_->experiment_file,
        "Experiment file for radii and speeds; else experiment.yaml beside the log");
  }
  void types(CLI::App* command) {
    command->add_option("--types", options_->types, kTypesHelp)
        ->allow_extra_args(false)
        ->take_all();
  }
  CLI::Option* out(CLI::App* command, const char* help) {
    return command->add_option("-o,--out", options_->out, help);
  }
  Options& options() { return *options_; }

 private:
  CLI::App& log_;
  std::shared_ptr<Options> options_;
};

void addExports(Commands& commands) {
  CLI::App* csv = commands.add(
      "csv", "One table a channel and one of all vehicles, with units in the headers", runCsv);
  commands.out(csv, "Folder; default: the log's name with _csv, here");
  commands.types(csv);
  commands.experiment(csv);

  CLI::App* mcap = commands.add("mcap", "For Foxglove and Lichtblick: JSON with schemas", runMcap);
  commands.out(mcap, "File; default: the log's name with .mcap, here");
  mcap->add_flag("--data-clock", commands.options().data_clock,
                 "Time is that of the vehicle states: for flights faster than real time");
  commands.types(mcap);

  CLI::App* cut = commands.add("cut", "A shorter log: a time span, some channels", runCut);
  commands.out(cut, "File")->required();
  CutOptions& options = commands.options().cut;
  cut->add_option("--from", options.from_s, "s of wall clock since the first event")
      ->check(CLI::NonNegativeNumber);
  cut->add_option("--to", options.to_s, "s of wall clock since the first event")
      ->check(CLI::NonNegativeNumber);
  cut->add_option("--channel", options.only, "Regular expression for whole names; repeatable")
      ->allow_extra_args(false)
      ->take_all();
  cut->add_option("--without", options.except, "Channels to leave out; repeatable")
      ->allow_extra_args(false)
      ->take_all();
}

}  // namespace

void addLogCommands(CLI::App& app) {
  Commands commands(app, std::make_shared<Options>());

  CLI::App* info =
      commands.add("info", "What a log holds, channel by channel, and what is damaged", runInfo);
  commands.types(info);

  CLI::App* metrics = commands.add("metrics", "Separation, arrival, rates, faults", runMetrics);
  metrics->add_option("--json", commands.options().json_file, "Also write everything to this file");
  commands.experiment(metrics);

  CLI::App* plot = commands.add("plot", "Pictures (PNG and SVG) and the report", runPlot);
  commands.out(plot, "Folder for the pictures")->required();
  commands.experiment(plot);

  CLI::App* report =
      commands.add("report", "One page that plays the flight; needs no other file", runReport);
  commands.out(report, "File; default: the log's name with .html, here");
  commands.experiment(report);

  addExports(commands);

  CLI::App* compare =
      commands.add("compare", "Where states and commands of two flights part", runCompare);
  compare->add_option("other", commands.options().other_log_file, "The other log")->required();
  compare->add_option("--tolerance", commands.options().tolerance_m, "m between states")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  commands.experiment(compare);
}

}  // namespace roundabout::logs
