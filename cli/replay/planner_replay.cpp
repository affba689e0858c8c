#include "cli/replay/planner_replay.h"

#include <algorithm>
#include <csignal>
#include <set>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "cli/process.h"
#include "cli/wall_clock.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/plausible.h"
#include "common/bus/typed.h"
#include "common/core/error.h"
#include "logs/replay/command_check.h"
#include "logs/replay/log_player.h"
#include "roundabout_msgs/planner_status_t.hpp"

namespace roundabout::cli {

namespace {

using std::chrono::milliseconds;

constexpr double kStartLimit_s = 20.0;
constexpr double kAnswerLimit_s = 3.0;
constexpr int kMostUnanswered = 3;
constexpr double kLastAnswers_s = 0.3;

/// Where no flight is: below the ports that the kernel hands out by itself.
std::string privateUrl() {
  constexpr int kFirstPort = 30000;
  constexpr int kPorts = 2700;
  return fmt::format("udpm://239.255.76.67:{}?ttl=0", kFirstPort + getpid() % kPorts);
}

/// A planner process and what it says.
class PlannerUnderTest {
 public:
  PlannerUnderTest(const PlannerReplay& plan, app::StopSignal& stop)
      : vehicle_(plan.vehicle), stop_(stop), bus_(privateUrl()), process_(commandFor(plan)) {
    bus::subscribe<roundabout_msgs::command_t>(
        bus_, bus::commandChannel(vehicle_),
        [this](const roundabout_msgs::command_t& message) {
          core::Command command;
          if (bus::fromMessage(message, command) == nullptr) {
            commands_.emplace(command.state_utime, command);
          }
        },
        [](const bus::DecodeError&) {});
    bus::subscribe<roundabout_msgs::planner_status_t>(
        bus_, bus::plannerStatusChannel(vehicle_),
        [this](const roundabout_msgs::planner_status_t&) { alive_ = true; },
        [](const bus::DecodeError&) {});
    const double since_s = wallSeconds();
    while (!alive_) {
      listen(milliseconds(20));
      if (wallSeconds() - since_s > kStartLimit_s) {
        throw core::StartupError(process_.name(), "replay", "a planner that starts",
                                 fmt::format("none within {} s", kStartLimit_s));
      }
    }
  }

  ~PlannerUnderTest() { process_.stop(SIGTERM, milliseconds(2000)); }

  /// True if it is none of the planner's own words.
  bool hears(std::string_view channel) const {
    return channel != bus::commandChannel(vehicle_) &&
           channel != bus::plannerStatusChannel(vehicle_);
  }

  void say(const logs::Event& event) {
    if (hears(event.channel)) {
      bus_.publish(std::string(event.channel), event.payload);
    }
  }

  void listen(milliseconds time) {
    bus_.handle(time);
    if (stop_.requested()) {
      throw std::runtime_error("stopped");
    }
    if (const auto status = process_.exited()) {
      std::string lines;
      for (const std::string& line : process_.lastLines(3)) {
        lines += "\n  " + line;
      }
      throw std::runtime_error(process_.name() + " ended, " + status->describe() + lines);
    }
  }

  void listenFor(double time_s) {
    for (const double since_s = wallSeconds(); wallSeconds() - since_s < time_s;) {
      listen(milliseconds(10));
    }
  }

  /// False if it does not answer in time.
  bool waitForAnswer(core::Utime utime) {
    for (const double since_s = wallSeconds(); !commands_.contains(utime);) {
      listen(milliseconds(10));
      if (wallSeconds() - since_s > kAnswerLimit_s) {
        return false;
      }
    }
    return true;
  }

  const std::map<core::Utime, core::Command>& commands() const { return commands_; }

 private:
  static ProcessCommand commandFor(const PlannerReplay& plan) {
    ProcessCommand command;
    command.name = "planner " + plan.vehicle;
    command.output_file =
        std::filesystem::temp_directory_path() / fmt::format("roundabout-replay-{}.log", getpid());
    command.arguments = {(plan.programs / "planner").string(),
                         "--config",
                         plan.experiment_file,
                         "--vehicle",
                         plan.vehicle,
                         "--lcm-url",
                         privateUrl(),
                         "--set",
                         "planner.watch_wall_clock=false"};
    std::vector<std::string> overrides = plan.overrides;
    if (!plan.policy.empty()) {
      overrides.push_back("planner.policy=" + plan.policy);
    }
    for (const std::string& text : overrides) {
      command.arguments.insert(command.arguments.end(), {"--set", text});
    }
    return command;
  }

  std::string vehicle_;
  app::StopSignal& stop_;
  bus::LcmBus bus_;
  ChildProcess process_;
  bool alive_ = false;
  std::map<core::Utime, core::Command> commands_;
};

const logs::FlightVehicle& vehicleIn(const logs::Flight& flight, const std::string& name) {
  const auto found = std::find_if(flight.vehicles.begin(), flight.vehicles.end(),
                                  [&](const auto& vehicle) { return vehicle.name == name; });
  if (found == flight.vehicles.end()) {
    throw core::StartupError(flight.log_file, "vehicle", "one of the log's", name);
  }
  return *found;
}

void replayInLockstep(PlannerUnderTest& planner, const logs::EventLog& log,
                      const std::vector<core::Utime>& ticks, Console& console) {
  std::set<core::Utime> waiting(ticks.begin(), ticks.end());
  int unanswered = 0;
  for (std::size_t i = 0; i < log.size(); ++i) {
    const logs::Event event = log[i];
    planner.say(event);
    if (event.channel != bus::kStatesChannel || event.payload.size() < 16) {
      continue;
    }
    const auto utime = static_cast<core::Utime>(bus::bigEndian(event.payload, 8, 8));
    if (waiting.erase(utime) == 0) {
      continue;
    }
    unanswered = planner.waitForAnswer(utime) ? 0 : unanswered + 1;
    if (unanswered == kMostUnanswered) {
      throw std::runtime_error(
          fmt::format("the planner left {} ticks in a row unanswered", kMostUnanswered));
    }
    console.progress(fmt::format("event {} of {}", i + 1, log.size()));
  }
}

void replayAtSpeed(PlannerUnderTest& planner, const logs::EventLog& log, double speed,
                   bool data_clock, Console& console) {
  logs::PlayOptions options;
  options.speed = speed;
  options.data_clock = data_clock;
  logs::LogPlayer player(log, options);
  while (!player.atEnd()) {
    player.advance(wallSeconds(), [&](const logs::Event& event) { planner.say(event); });
    planner.listen(milliseconds(1));
    console.progress(fmt::format("{:.1f} of {:.1f} s", player.positionS(), player.endS()));
  }
}

}  // namespace

std::map<core::Utime, core::Command> replayToPlanner(const PlannerReplay& plan,
                                                     const logs::EventLog& log,
                                                     const logs::Flight& flight,
                                                     app::StopSignal& stop, Console& console) {
  const logs::FlightVehicle& vehicle = vehicleIn(flight, plan.vehicle);
  PlannerUnderTest planner(plan, stop);
  if (plan.speed) {
    replayAtSpeed(planner, log, *plan.speed, plan.data_clock, console);
  } else {
    replayInLockstep(planner, log, logs::answeredFrames(flight, vehicle), console);
  }
  planner.listenFor(kLastAnswers_s);
  std::map<core::Utime, core::Command> commands = planner.commands();
  commands.erase(0);  // answers no state
  return commands;
}

}  // namespace roundabout::cli
