#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/process.h"
#include "common/bus/lcm_bus.h"
#include "roundabout_msgs/command_t.hpp"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/planner_status_t.hpp"
#include "roundabout_msgs/vehicle_states_t.hpp"
#include "tests/support/scratch_folder.h"

namespace roundabout::test {

/// How a program ended and what it wrote.
struct Ended {
  cli::ExitStatus status;
  std::vector<std::string> lines;  ///< stdout and stderr, without empty lines
};

/// The latest message of every kind that was heard, and how many.
struct Heard {
  roundabout_msgs::vehicle_states_t states{};
  roundabout_msgs::fleet_status_t fleet{};
  std::map<std::string, roundabout_msgs::planner_status_t> planners;
  std::map<std::string, roundabout_msgs::command_t> commands;
  int frames = 0;
  int fleet_statuses = 0;
};

/// Starts the real executables on an LCM port of the test's own, listens to them, and leaves
/// nothing running. Every verb fails the test, by exception, when its limit passes.
class FlightLab : public testing::Test {
 protected:
  static constexpr std::chrono::seconds kLimit{40};

  FlightLab();
  ~FlightLab() override;

  /// Two multirotors, hex1 and hex2, that take off and swap places in a few seconds. `more` is
  /// appended: further keys of the experiment.
  std::string twoSwap(const std::string& more = "") const;
  /// Writes text to a file in the scratch folder; returns its path.
  std::string write(const std::string& name, const std::string& text) const;

  /// Starts an executable of this build, or a program in PATH; adds --lcm-url if it is ours.
  cli::ProcessCommand command(const std::string& program,
                              const std::vector<std::string>& arguments);
  cli::ChildProcess& start(const std::string& program, const std::vector<std::string>& arguments);
  Ended finish(cli::ChildProcess& process);
  Ended run(const std::string& program, const std::vector<std::string>& arguments);

  /// `roundabout fly FILE --out <scratch>/out`.
  cli::ChildProcess& startFlight(const std::string& file, std::vector<std::string> arguments = {});
  std::filesystem::path out() const { return scratch_ / "out"; }

  void waitUntil(const std::string& what, const std::function<bool()>& condition);
  /// Listens for a stretch of wall-clock time.
  void listenFor(std::chrono::milliseconds time);
  const Heard& heard() const { return heard_; }
  bus::LcmBus& bus() { return *bus_; }
  const std::string& url() const { return url_; }

  /// The process that a flight started, by words of its command line ("planner", "hex1").
  std::optional<pid_t> findProcess(const std::vector<std::string>& words) const;
  void killProcess(const std::vector<std::string>& words) const;
  /// Command lines of this test's processes that still run, whoever started them.
  std::vector<std::string> leftRunning() const;

  double heightOf(const std::string& vehicle) const;
  int modeOf(const std::string& vehicle) const;

  ScratchFolder scratch_;

 private:
  std::string url_;
  std::unique_ptr<bus::LcmBus> bus_;
  std::vector<std::unique_ptr<cli::ChildProcess>> processes_;
  Heard heard_;
};

/// Payloads of a log, by channel, in the order of the file.
std::map<std::string, std::vector<std::string>> payloadsOf(const std::filesystem::path& log);

}  // namespace roundabout::test
