#include "cli/supervisor.h"

#include <chrono>
#include <csignal>
#include <utility>

#include <spdlog/fmt/fmt.h>

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
constexpr double kLockstepLanding_s = 10.0;
constexpr std::size_t kLinesShown = 5;

std::vector<std::string> namesOf(const config::Experiment& experiment) {
  std::vector<std::string> names;
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    names.push_back(vehicle.name);
  }
  return names;
}

DirectorLimits limitsOf(const config::Experiment& experiment) {
  DirectorLimits limits;
  if (experiment.sim.pacing == "lockstep") {
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
    case Role::kFleet:
      return "vehicles hold at their goals; all land unless a new fleet is started";
    case Role::kSim:
      return "nothing flies any more";
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
  for (const std::string& vehicle : namesOf(plan_.experiment)) {
    start(Role::kPlanner, "planner", vehicle);
  }
  start(Role::kFleet, "fleet", "");
  start(Role::kSim, "sim", "");
}

FlightResult Supervisor::run() {
  Direction direction = Direction::kGoOn;
  while (direction != Direction::kEnd && stop_.count() < 2) {
    bus_.handle(kStep);
    reap();
    if (stop_.requested()) {
      director_.onStop();
    }
    direction = director_.decide(wallSeconds());
    if (direction == Direction::kLand) {
      orderLanding();
    }
    if (flying() && console_.progressDue()) {
      console_.progress(describe(monitor_->progress(), wallSeconds() - *first_state_s_));
    }
  }
  bus_.handle(milliseconds(0));
  const double ended_s = wallSeconds();
  stopProcesses();

  FlightResult result;
  result.states_seen = flying();
  result.mission_done = monitor_->missionDone();
  result.interrupted = stop_.requested();
  result.set_up_s = first_state_s_.value_or(ended_s) - created_s_;
  result.wall_s = ended_s - first_state_s_.value_or(ended_s);
  result.data_s = monitor_->progress().elapsed_s();
  result.events = events_;
  if (!director_.reason().empty()) {
    result.events.push_back("ended early: " + director_.reason());
  }
  return result;
}

void Supervisor::start(Role role, const std::string& program, const std::string& vehicle) {
  ProcessCommand command;
  command.name = vehicle.empty() ? program : program + "_" + vehicle;
  command.arguments = {(plan_.programs / program).string(), "--config",
                       plan_.experimentFile().string(), "--lcm-url", plan_.lcm_url};
  if (!vehicle.empty()) {
    command.arguments.insert(command.arguments.end(), {"--vehicle", vehicle});
  }
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
    reportEnd(child, *status);
    director_.onEnd(child.role, child.vehicle, status->clean(), wallSeconds());
  }
}

void Supervisor::reportEnd(const Child& child, const ExitStatus& status) {
  if (child.role == Role::kSim && status.clean()) {
    return;
  }
  const std::vector<std::string> lines = child.process->lastLines(kLinesShown);
  const std::string what = fmt::format("{}: {}", child.process->name(), status.describe());
  if (!flying()) {
    throw ChildFailure(lines.empty() ? what + " before the flight began"
                                     : inTheUsersWords(lines.back()));
  }
  const std::string event = fmt::format("{:.2f} s: {}; {}", monitor_->progress().elapsed_s(), what,
                                        consequence(child.role));
  events_.push_back(event);
  console_.say(event);
  for (const std::string& line : lines) {
    console_.say("    " + line);
  }
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
  recorder_->close();
}

}  // namespace roundabout::cli
