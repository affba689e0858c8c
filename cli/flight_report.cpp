#include "cli/flight_report.h"

#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace roundabout::cli {

bool reportFlight(const FlightPlan& plan, const FlightResult& result, bool /*with_files*/,
                  Console& console) {
  const bool touched = result.closest_separation_m <= 0.0;
  for (const std::string& event : result.events) {
    console.say("  " + event);
  }
  if (!result.states_seen) {
    console.say("nothing flew");
    return false;
  }
  console.say(fmt::format(
      "{}: {:.1f} s flown in {:.1f} s of wall clock ({:.1f}x real time), set up in {:.1f} s",
      result.mission_done ? "mission complete" : "mission not complete", result.data_s,
      result.wall_s, result.data_s / result.wall_s, result.set_up_s));
  if (std::isfinite(result.closest_separation_m)) {
    console.say(fmt::format("closest bodies: {:.3f} m{}", result.closest_separation_m,
                            touched ? " (they touched)" : ""));
  }
  console.say("files: " + plan.folder.string());
  return result.mission_done && !touched;
}

}  // namespace roundabout::cli
