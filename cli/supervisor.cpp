#include "cli/supervisor.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <sstream>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "cli/wall_clock.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/core/error.h"

namespace roundabout::cli {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kStep(20);
constexpr milliseconds kExitLimit(2000);
constexpr double kLandingRepeat_s = 1.0;
constexpr double kLogPeriod_s = 0.2;
constexpr double kLockstepLanding_s = 10.0;
constexpr std::size_t kLinesShown = 5;
constexpr int kRefusedToStart = 2;

std::vector<std::string> namesOf(const config::Experiment& experiment) {
  std::vector<std::string> names;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    names.push_back(vehicle.name);
  }
  return names;
}

DirectorLimits limitsOf(const config::Experiment& experiment) {
  DirectorLimits limits;
  if (experiment.source == "sim" && experiment.sim.pacing == "lockstep") {
    limits.landing_s = kLockstepLanding_s;
  }
  return limits;
}

const char* consequence(Role role) {
  switch (role) {
    case Role::kLogger:
      return "all land, since a flight without a log is no experiment";
    case Role::kPlanner:
      return "its vehicle holds, then lands by itself; the others go on";
    case Role::kPerception:
      return "its vehicle holds: it sees nobody";
    case Role::kFleet:
      return "vehicles hold at their goals; all land unless a new fleet is started";
    case Role::kSim:
      return "nothing flies any more";
    case Role::kMocap:
      return "without states vehicles hold, then land by themselves";
  }
  return "";
}

}  // namespace

Supervisor::Supervisor(FlightPlan plan, bus::Bus& bus, app::StopSignal& stop, Console& console)
    : plan_(std::move(plan)),
      bus_(bus),
      stop_(stop),
      console_(console),
      director_(namesOf(plan_.experiment), limitsOf(plan_.experiment)),
      created_s_(wallSeconds()) {
  FlightMonitor::Events events;
  events.first_state = [this] {
    first_state_s_ = wallSeconds();
    director_.onFirstState();
  };
  events.fleet_heard = [this] { director_.onFleetHeard(wallSeconds()); };
  events.planner_heard = [this](const std::string& vehicle, bool on_floor) {
    director_.onPlannerHeard(vehicle, on_floor, wallSeconds());
  };
  monitor_ = std::make_unique<FlightMonitor>(bus_, plan_.experiment, std::move(events));

  const std::filesystem::path logs = plan_.folder / "logs";
  std::filesystem::create_directories(logs);
  recorder_ =
      std::make_unique<Recorder>(bus_, plan_.lcm_url, plan_.logFile(), logs / "lcm-logger.log");
  children_.push_back({Role::kLogger, "", &recorder_->process()});
  for (const config::Vehicle& vehicle : plan_.experiment.vehicles) {
    start(Role::kPlanner, "planner", vehicle.name);
    if (config::seesForItself(plan_.experiment, vehicle)) {
      start(Role::kPerception, "perception", vehicle.name);
    }
  }
  start(Role::kFleet, "fleet", "");
  startStates();
}

// The simulator, a motion-capture system, or one that is emulated, with the simulator behind it.
void Supervisor::startStates() {
  const config::Experiment& experiment = plan_.experiment;
  if (experiment.source == "sim") {
    start(Role::kSim, "sim", "");
    return;
  }
  if (plan_.emulate_mocap) {
    startRaw(Role::kMocap, "", "emulator",
             {(plan_.programs / "roundabout").string(), "mocap", "emulate", experiment.source,
              "--scene", "sim", "--lcm-url", plan_.lcm_url, "--rate",
              fmt::format("{}", experiment.sim.mocap.rate_hz), "--command-port",
              std::to_string(experiment.mocap.command_port), "--data-port",
              std::to_string(experiment.mocap.data_port)});
  }
  start(Role::kMocap, "mocap_bridge", "");
  bridge_log_.emplace(plan_.folder / "logs" / "mocap_bridge.log");
  if (plan_.emulate_mocap) {
    start(Role::kSim, "sim", "", {"--scene"});
  }
}

FlightResult Supervisor::run() {
  Direction direction = Direction::kGoOn;
  while (direction != Direction::kEnd && stop_.count() < 2) {
    listen();
    direction = direct();
  }
  listen();
  const double ended_s = wallSeconds();
  if (!director_.notLanded().empty()) {
    report(fmt::format("{:.2f} s: the time to land is up and not on the floor: {}",
                       monitor_->progress().elapsed_s(), fmt::join(director_.notLanded(), ", ")));
  }
  stopProcesses();

  FlightResult result;
  result.log_complete = closeLog();
  result.states_seen = flying();
  result.interrupted = stop_.requested();
  result.orderly = !director_.early() && director_.notLanded().empty();
  result.set_up_s = first_state_s_.value_or(ended_s) - created_s_;
  result.wall_s = ended_s - first_state_s_.value_or(ended_s);
  result.data_s = monitor_->progress().elapsed_s();
  result.events = events_;
  if (director_.early()) {
    result.events.push_back("ended early: " + director_.reason());
  }
  return result;
}

// Whatever is thrown while something flies, it lands first.
void Supervisor::listen() {
  try {
    bus_.handle(kStep);
    if (wallSeconds() - bridge_log_read_s_ >= kLogPeriod_s) {
      showBridgeWarnings();
    }
    reap();
    if (flying() && console_.progressDue()) {
      console_.progress(describe(monitor_->progress(), wallSeconds() - *first_state_s_));
    }
  } catch (const std::exception& error) {
    if (!flying()) {
      throw;
    }
    director_.onFailure(error.what());
  }
}

Direction Supervisor::direct() {
  if (stop_.requested()) {
    director_.onStop();
  }
  if (monitor_->missionOver()) {
    director_.onMissionOver();
  }
  const bool simulated = plan_.experiment.source == "sim" || plan_.emulate_mocap;
  if (!simulated && monitor_->missionEnded()) {
    director_.onFleetDone();
  }
  const Direction direction = director_.decide(wallSeconds());
  if (direction == Direction::kLand) {
    orderLanding();
  }
  return direction;
}

void Supervisor::start(Role role, const std::string& program, const std::string& vehicle,
                       const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {(plan_.programs / program).string(), "--config",
                                        plan_.experimentFile().string(), "--lcm-url",
                                        plan_.lcm_url};
  if (!vehicle.empty()) {
    arguments.insert(arguments.end(), {"--vehicle", vehicle});
  }
  arguments.insert(arguments.end(), more.begin(), more.end());
  startRaw(role, vehicle, vehicle.empty() ? program : program + "_" + vehicle,
           std::move(arguments));
}

void Supervisor::startRaw(Role role, const std::string& vehicle, const std::string& name,
                          std::vector<std::string> arguments) {
  ProcessCommand command;
  command.name = name;
  command.arguments = std::move(arguments);
  command.output_file = plan_.folder / "logs" / (command.name + ".log");
  processes_.push_back(std::make_unique<ChildProcess>(std::move(command)));
  children_.push_back({role, vehicle, processes_.back().get()});
}

void Supervisor::reap() {
  for (Child& child : children_) {
    const auto status = child.process->exited();
    if (!status || child.end_reported) {
      continue;
    }
    child.end_reported = true;
    director_.onEnd(child.role, child.vehicle, status->clean(), wallSeconds());
    reportEnd(child, *status);
  }
}

void Supervisor::reportEnd(const Child& child, const ExitStatus& status) {
  showBridgeWarnings();  // the last, too
  if (child.role == Role::kSim && status.clean()) {
    if (flying() && !monitor_->missionEnded()) {
      report(
          fmt::format("{:.2f} s: sim ended before the mission did: it was stopped, or "
                      "sim.max_duration_s ({} s) was up",
                      monitor_->progress().elapsed_s(), plan_.experiment.sim.max_duration_s));
    }
    return;
  }
  std::vector<std::string> lines = child.process->lastLines(kLinesShown);
  std::transform(lines.begin(), lines.end(), lines.begin(),
                 [this](const std::string& line) { return inTheUsersWords(line); });
  if (!flying() && status.code == kRefusedToStart && !lines.empty()) {
    throw ChildFailure(lines.back());
  }
  const std::string what = fmt::format("{}: {}", child.process->name(), status.describe());
  if (!flying()) {
    lines.insert(lines.begin(), what + " before the flight began");
    throw ChildFailure(fmt::format("{}", fmt::join(lines, "\n    ")));
  }
  report(fmt::format("{:.2f} s: {}; {}", monitor_->progress().elapsed_s(), what,
                     consequence(child.role)));
  for (const std::string& line : lines) {
    console_.say("    " + line);
  }
}

void Supervisor::showBridgeWarnings() {
  if (!bridge_log_) {
    return;
  }
  bridge_log_read_s_ = wallSeconds();
  for (const std::string& line : bridge_log_->newLines()) {
    std::istringstream words(line);
    std::string time, name, level, text;
    words >> time >> name >> level >> std::ws;
    if ((level == "warning" || level == "error") && std::getline(words, text)) {
      console_.say(name + ": " + text);
    }
  }
}

void Supervisor::report(const std::string& event) {
  events_.push_back(event);
  console_.say(event);
}

// Processes read the resolved experiment; the user knows the file that it came from.
std::string Supervisor::inTheUsersWords(std::string line) const {
  const std::string resolved = plan_.experimentFile().string();
  if (const std::size_t at = line.find(resolved); at != std::string::npos) {
    line.replace(at, resolved.size(), plan_.experiment.file);
  }
  return line;
}

void Supervisor::orderLanding() {
  const double now_s = wallSeconds();
  if (landing_ordered_s_ && now_s - *landing_ordered_s_ < kLandingRepeat_s) {
    return;
  }
  if (!landing_ordered_s_) {
    console_.say("landing all: " + director_.reason());
  }
  landing_ordered_s_ = now_s;
  core::SafetyOrder order;
  order.utime = wallTime();
  order.order = core::SafetyOrderKind::kLand;
  bus::publish(bus_, bus::kSafetyOrderChannel, bus::toMessage(order));
}

void Supervisor::stopProcesses() {
  const bool at_once = stop_.count() > 1;
  for (const auto& process : processes_) {
    process->signal(at_once ? SIGKILL : SIGTERM);
  }
  for (const auto& process : processes_) {
    process->stop(SIGTERM, kExitLimit);
  }
}

bool Supervisor::closeLog() {
  const std::string what_is_wrong = recorder_->close();
  if (!what_is_wrong.empty()) {
    report("the log is not complete: " + what_is_wrong);
  }
  return what_is_wrong.empty();
}

}  // namespace roundabout::cli
