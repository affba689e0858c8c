#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/file_tail.h"
#include "cli/flight_director.h"
#include "cli/flight_monitor.h"
#include "cli/process.h"
#include "cli/recorder.h"
#include "common/app/stop_signal.h"
#include "common/bus/bus.h"
#include "common/config/experiment.h"

namespace roundabout::cli {

/// What a flight needs beside a bus.
struct FlightPlan {
  config::Experiment experiment;
  std::string lcm_url;
  std::filesystem::path folder;    ///< has experiment.yaml in it
  std::filesystem::path programs;  ///< where sim, planner and fleet are
  std::string command_line;        ///< for the reader of the report
  bool emulate_mocap = false;      ///< of the experiment's source, with the simulator behind it

  std::filesystem::path logFile() const { return folder / "flight.lcm"; }
  /// The experiment with all overrides, as the processes read it.
  std::filesystem::path experimentFile() const { return folder / "experiment.yaml"; }
};

/// A process ended before the flight began. what() is its own last line if it refused to start
/// (exit status 2), else how it ended and what it wrote last.
class ChildFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct FlightResult {
  bool states_seen = false;
  bool orderly = false;             ///< to the end of the mission, and all landed that could
  bool interrupted = false;         ///< by the user
  bool log_complete = true;         ///< to its last message
  double set_up_s = 0.0;            ///< wall clock, until the first state
  double wall_s = 0.0;              ///< wall clock, from the first state to the end
  double data_s = 0.0;              ///< data time flown
  std::vector<std::string> events;  ///< what went wrong, one line each, in order of time
};

/// Starts the processes of one flight, watches them, and leaves none behind.
class Supervisor {
 public:
  /// Starts everything: the recorder first, the simulator last. Throws core::StartupError if a
  /// process cannot be started.
  Supervisor(FlightPlan plan, bus::Bus& bus, app::StopSignal& stop, Console& console);

  /// Until the flight is over and every process has ended. Before the first state, throws
  /// ChildFailure if a process ends, or what a handler threw; after it, everybody lands first and
  /// the events say why.
  FlightResult run();

 private:
  struct Child {
    Role role;
    std::string vehicle;  ///< of a planner; else empty
    ChildProcess* process;
    bool end_reported = false;
  };

  bool flying() const { return first_state_s_.has_value(); }
  /// With --config and --lcm-url, and more.
  void start(Role role, const std::string& program, const std::string& vehicle,
             const std::vector<std::string>& more = {});
  void startRaw(Role role, const std::string& vehicle, const std::string& name,
                std::vector<std::string> arguments);
  void startStates();
  void listen();
  Direction direct();
  void reap();
  /// What the bridge warns of is the operator's to mend: no server, a body that is not streamed.
  void showBridgeWarnings();
  void report(const std::string& event);
  std::string inTheUsersWords(std::string line) const;
  void reportEnd(const Child& child, const ExitStatus& status);
  void orderLanding();
  void stopProcesses();
  bool closeLog();

  FlightPlan plan_;
  bus::Bus& bus_;
  app::StopSignal& stop_;
  Console& console_;
  FlightDirector director_;
  std::unique_ptr<FlightMonitor> monitor_;
  std::unique_ptr<Recorder> recorder_;
  std::vector<std::unique_ptr<ChildProcess>> processes_;  ///< all but the recorder's
  std::vector<Child> children_;                           ///< in the order of their start
  std::optional<FileFollower> bridge_log_;
  double bridge_log_read_s_ = 0.0;
  double created_s_;
  std::optional<double> first_state_s_;
  std::optional<double> landing_ordered_s_;
  std::vector<std::string> events_;
};

}  // namespace roundabout::cli
