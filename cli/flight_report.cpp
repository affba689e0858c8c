#include "cli/flight_report.h"

#include <algorithm>
#include <exception>

#include <spdlog/fmt/fmt.h>

#include "logs/figures/figures.h"
#include "logs/metrics/metrics_json.h"
#include "logs/metrics/metrics_text.h"
#include "logs/report/report.h"

namespace roundabout::cli {

namespace {

constexpr double kShortestFlight_s = 1e-3;

bool writeFiles(const FlightPlan& plan, const logs::Flight& flight, const logs::Metrics& metrics,
                Console& console) {
  try {
    logs::writeMetricsJson(metrics, (plan.folder / "metrics.json").string());
    const logs::Figures figures = logs::drawFlight(flight, metrics, plan.folder.string());
    logs::writeReport((plan.folder / "report.html").string(), flight, metrics, figures,
                      plan.command_line);
    return true;
  } catch (const std::exception& error) {
    console.say(fmt::format("no pictures and report: {}", error.what()));
    return false;
  }
}

void sayHowItWent(const logs::Flight& flight, const logs::Metrics& metrics,
                  const FlightResult& result, Console& console) {
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
  sayHowItWent(flight, metrics, result, console);
  const bool all_files = with_files && writeFiles(plan, flight, metrics, console);
  console.say(fmt::format("{} in {}", all_files ? "log, metrics, report and pictures" : "log",
                          plan.folder.string()));
  return metrics.success && result.log_complete && result.orderly;
}

}  // namespace roundabout::cli
