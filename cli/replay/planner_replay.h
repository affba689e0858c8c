#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "common/app/stop_signal.h"
#include "common/core/command.h"
#include "logs/flight.h"
#include "logs/reading/event_log.h"

namespace roundabout::cli {

struct PlannerReplay {
  std::filesystem::path programs;  ///< folder of the planner's executable
  std::string experiment_file;
  std::string vehicle;
  std::string policy;  ///< empty: the experiment's
  std::vector<std::string> overrides;
  std::optional<double> speed;  ///< times the pace of the log; nothing: lockstep
  bool data_clock = false;      ///< the pace is that of the vehicle states
};

/// Starts a planner process on an LCM URL of its own, lets it hear what is in the log but its own
/// words, and returns its commands by the utime of the state that they answer. In lockstep the next
/// frame waits for the answer to the last. Throws core::StartupError if the planner does not start,
/// std::runtime_error if it ends or stops answering, or the user stops.
std::map<core::Utime, core::Command> replayToPlanner(const PlannerReplay& plan,
                                                     const logs::EventLog& log,
                                                     const logs::Flight& flight,
                                                     app::StopSignal& stop, Console& console);

}  // namespace roundabout::cli
