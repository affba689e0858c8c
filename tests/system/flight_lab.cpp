#include "tests/system/flight_lab.h"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "logs/reading/event_log.h"
#include "tests/support/lcm_url.h"

namespace roundabout::test {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStep(10);
constexpr std::size_t kAllLines = 10'000;

std::vector<std::string> commandLineOf(const std::filesystem::path& process) {
  std::ifstream file(process / "cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) {
    words.push_back(word);
  }
  return words;
}

bool mentions(const std::vector<std::string>& command_line, const std::string& text) {
  return std::any_of(command_line.begin(), command_line.end(),
                     [&](const std::string& word) { return word.find(text) != std::string::npos; });
}

template <class Call>
void forEveryProcess(Call call) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); })) {
      call(static_cast<pid_t>(std::stol(name)), commandLineOf(entry.path()));
    }
  }
}

void ignore(const bus::DecodeError&) {}

}  // namespace

FlightLab::FlightLab() : url_(ownLcmUrl()), bus_(std::make_unique<bus::LcmBus>(url_)) {
  bus::subscribe<roundabout_msgs::vehicle_states_t>(
      *bus_, bus::kStatesChannel,
      [this](const auto& message) {
        heard_.states = message;
        ++heard_.frames;
      },
      ignore);
  bus::subscribe<roundabout_msgs::fleet_status_t>(
      *bus_, bus::kFleetStatusChannel,
      [this](const auto& message) {
        heard_.fleet = message;
        ++heard_.fleet_statuses;
      },
      ignore);
  for (const std::string vehicle : {"hex1", "hex2", "rover"}) {
    bus::subscribe<roundabout_msgs::planner_status_t>(
        *bus_, bus::plannerStatusChannel(vehicle),
        [this, vehicle](const auto& message) { heard_.planners[vehicle] = message; }, ignore);
    bus::subscribe<roundabout_msgs::command_t>(
        *bus_, bus::commandChannel(vehicle),
        [this, vehicle](const auto& message) { heard_.commands[vehicle] = message; }, ignore);
  }
}

FlightLab::~FlightLab() {
  if (HasFailure()) {
    for (const auto& process : processes_) {
      for (const std::string& line : process->lastLines(20)) {
        fprintf(stderr, "%s | %s\n", process->name().c_str(), line.c_str());
      }
    }
  }
}

std::string FlightLab::twoSwap(const std::string& more) const {
  return write("two_swap.yaml", R"(name: two_swap
seed: 3
room: {min_m: [-5, -5, 0], max_m: [5, 5, 3]}
vehicle_defaults: {preferred_speed_mps: 1.0}
vehicles:
  - {name: hex1, start: {position_m: [-1.5, 0]}}
  - {name: hex2, start: {position_m: [1.5, 0]}}
mission:
  - take_off
  - formation: {name: swap, points: [[1.5, 0.1], [-1.5, 0]], seconds: 0.5}
  - land
)" + more);
}

std::string FlightLab::write(const std::string& name, const std::string& text) const {
  const std::filesystem::path file = scratch_ / name;
  std::ofstream(file) << text;
  return file.string();
}

cli::ProcessCommand FlightLab::command(const std::string& program,
                                       const std::vector<std::string>& arguments) {
  const std::string own = std::string(ROUNDABOUT_BIN_DIR) + "/" + program;
  cli::ProcessCommand command;
  command.name = program + std::to_string(processes_.size());
  command.output_file = scratch_ / (command.name + ".log");
  command.arguments = {std::filesystem::exists(own) ? own : program};
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  return command;
}

cli::ChildProcess& FlightLab::start(const std::string& program,
                                    const std::vector<std::string>& arguments) {
  return *processes_.emplace_back(std::make_unique<cli::ChildProcess>(command(program, arguments)));
}

Ended FlightLab::finish(cli::ChildProcess& process) {
  waitUntil("the end of " + process.name(), [&] { return process.exited().has_value(); });
  return {*process.exited(), process.lastLines(kAllLines)};
}

Ended FlightLab::run(const std::string& program, const std::vector<std::string>& arguments) {
  return finish(start(program, arguments));
}

cli::ChildProcess& FlightLab::startFlight(const std::string& file,
                                          std::vector<std::string> arguments) {
  std::vector<std::string> all{"fly", file, "--out", out().string(), "--lcm-url", url_};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return start("roundabout", all);
}

void FlightLab::waitUntil(const std::string& what, const std::function<bool()>& condition) {
  const auto since = steady_clock::now();
  while (!condition()) {
    if (steady_clock::now() - since > kLimit) {
      throw std::runtime_error("waited in vain for " + what);
    }
    bus_->handle(kStep);
  }
}

void FlightLab::listenFor(milliseconds time) {
  const auto until = steady_clock::now() + time;
  waitUntil("time to pass", [&] { return steady_clock::now() >= until; });
}

std::optional<pid_t> FlightLab::findProcess(const std::vector<std::string>& words) const {
  std::optional<pid_t> found;
  forEveryProcess([&](pid_t pid, const std::vector<std::string>& command_line) {
    const bool all = mentions(command_line, scratch_.path().string()) &&
                     std::all_of(words.begin(), words.end(), [&](const std::string& word) {
                       return std::any_of(command_line.begin(), command_line.end(),
                                          [&](const std::string& part) {
                                            return std::filesystem::path(part).filename() == word;
                                          });
                     });
    found = all ? pid : found;
  });
  return found;
}

void FlightLab::killProcess(const std::vector<std::string>& words) const {
  const auto pid = findProcess(words);
  if (!pid) {
    throw std::runtime_error("no such process: " + words.front());
  }
  kill(*pid, SIGKILL);
}

std::vector<std::string> FlightLab::leftRunning() const {
  std::vector<std::string> left;
  forEveryProcess([&](pid_t, const std::vector<std::string>& command_line) {
    if (mentions(command_line, scratch_.path().string())) {
      left.push_back(command_line.front());
    }
  });
  return left;
}

double FlightLab::heightOf(const std::string& vehicle) const {
  for (const auto& state : heard_.states.vehicles) {
    if (state.name == vehicle) {
      return state.position[2];
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

int FlightLab::modeOf(const std::string& vehicle) const {
  const auto found = heard_.planners.find(vehicle);
  return found == heard_.planners.end() ? -1 : found->second.mode;
}

std::map<std::string, std::vector<std::string>> payloadsOf(const std::filesystem::path& log) {
  std::map<std::string, std::vector<std::string>> payloads;
  for (const logs::Event event : logs::EventLog(log.string())) {
    payloads[std::string(event.channel)].emplace_back(
        reinterpret_cast<const char*>(event.payload.data()), event.payload.size());
  }
  return payloads;
}

}  // namespace roundabout::test
