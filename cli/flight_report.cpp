#include "cli/flight_report.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "logs/figures/figures.h"
#include "logs/metrics/metrics_json.h"
#include "logs/metrics/metrics_text.h"
#include "logs/report/report.h"

namespace roundabout::cli {

namespace {

constexpr double kShortestFlight_s = 1e-3;

void writeFiles(const FlightPlan& plan, const logs::Flight& flight, const logs::Metrics& metrics) {
  logs::writeMetricsJson(metrics, (plan.folder / "metrics.json").string());
  const logs::Figures figures = logs::drawFlight(flight, metrics, plan.folder.string());
  logs::writeReport((plan.folder / "report.html").string(), flight, metrics, figures,
                    plan.command_line);
}

}  // namespace

bool reportFlight(const FlightPlan& plan, const FlightResult& result, bool with_files,
                  Console& console) {
  if (!result.states_seen) {
    console.say("nothing flew; files are in " + plan.folder.string());
    return false;
  }
  const logs::Flight flight = logs::readFlight(plan.logFile().string());
  const logs::Metrics metrics = logs::computeMetrics(flight);
  if (with_files) {
    writeFiles(plan, flight, metrics);
  }
  console.say("");
  console.say(logs::toText(flight, metrics));
  for (const std::string& event : result.events) {
    console.say(event);
  }
  console.say(
      fmt::format("flight {:.1f} s of wall clock for {:.1f} s of data ({:.1f} x real time); "
                  "set-up before it {:.1f} s",
                  result.wall_s, result.data_s,
                  result.data_s / std::max(result.wall_s, kShortestFlight_s), result.set_up_s));
  console.say(fmt::format("{} in {}", with_files ? "log, metrics, report and pictures" : "log",
                          plan.folder.string()));
  return result.mission_done && metrics.success;
}

}  // namespace roundabout::cli
