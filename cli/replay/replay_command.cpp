#include "cli/replay/replay_command.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "cli/console.h"
#include "cli/replay/keys.h"
#include "cli/replay/planner_replay.h"
#include "cli/wall_clock.h"
#include "common/app/stop_signal.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/listen.h"
#include "common/bus/messages.h"
#include "common/core/error.h"
#include "logs/figures/what_if_figure.h"
#include "logs/files.h"
#include "logs/replay/command_check.h"
#include "logs/replay/log_player.h"

namespace roundabout::cli {

namespace {

using std::chrono::milliseconds;

constexpr int kInterrupted = 130;
constexpr double kSeekStep_s = 5.0;

struct ReplayOptions {
  std::string log_file;
  logs::PlayOptions play;
  std::optional<double> speed;
  std::vector<std::string> renames;
  std::string check;
  std::string policy;
  std::string vehicle;
  std::string folder = "what_if";
  std::string experiment_file;
  std::vector<std::string> overrides;
  std::string lcm_url;
};

std::map<std::string, std::string, std::less<>> renamesOf(const ReplayOptions& options) {
  std::map<std::string, std::string, std::less<>> renames;
  for (const std::string& text : options.renames) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw core::StartupError("replay", "--rename", "OLD=NEW", text);
    }
    renames[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return renames;
}

/// Recorded commands must not fly anybody.
void requireNobodyPublishes(const std::string& url) {
  bus::LcmBus bus(url);
  if (!bus::heardWithin(milliseconds(300), bus, {bus::kStatesChannel, bus::kFleetStatusChannel})
           .empty()) {
    throw core::StartupError(url, "replay", "a URL on which nothing flies (use another --lcm-url)",
                             "VEHICLE_STATES or FLEET_STATUS of somebody else");
  }
}

void onKey(Key key, logs::LogPlayer& player, const logs::LogPlayer::Publish& publish) {
  const double now_s = wallSeconds();
  switch (key) {
    case Key::kSpace:
      player.paused() ? player.play(now_s) : player.pause(now_s);
      break;
    case Key::kLeft:
      player.seek(now_s, player.positionS() - kSeekStep_s);
      break;
    case Key::kRight:
      player.seek(now_s, player.positionS() + kSeekStep_s);
      break;
    case Key::kUp:
      player.setSpeed(now_s, player.speed() * 2.0);
      break;
    case Key::kDown:
      player.setSpeed(now_s, player.speed() / 2.0);
      break;
    case Key::kStep:
      player.step(now_s, publish);
      break;
    case Key::kLoop:
      player.setLoop(!player.loop());
      break;
    case Key::kBegin:
      player.seek(now_s, 0.0);
      break;
    case Key::kQuit:
      break;
  }
}

std::string progressOf(const logs::LogPlayer& player) {
  return fmt::format("{} {:8.2f} / {:.2f} s  × {:g}{}  {} events",
                     player.paused() ? "paused " : "playing", player.positionS(), player.endS(),
                     player.speed(), player.loop() ? "  loop" : "", player.published());
}

int playLog(const ReplayOptions& options) {
  standWithoutTerminal();
  const logs::EventLog log(options.log_file);
  const auto renames = renamesOf(options);
  logs::PlayOptions play = options.play;
  play.speed = options.speed.value_or(1.0);
  logs::LogPlayer player(log, play);
  const std::string url = bus::resolveUrl(options.lcm_url);
  requireNobodyPublishes(url);
  app::StopSignal stop;
  bus::LcmBus bus(url);
  Console console;
  Keys keys;
  if (keys.terminal()) {
    console.say(kKeysHelp);
  }
  const auto publish = [&](const logs::Event& event) {
    const auto renamed = renames.find(event.channel);
    bus.publish(renamed == renames.end() ? std::string(event.channel) : renamed->second,
                event.payload);
  };
  // With keys the end is a place to go back from.
  while (!(player.atEnd() && !player.loop() && !keys.terminal())) {
    if (stop.requested()) {
      return kInterrupted;
    }
    const auto key = keys.next();
    if (key == Key::kQuit) {
      return 0;
    }
    if (key) {
      onKey(*key, player, publish);
    }
    player.advance(wallSeconds(), publish);
    console.progress(progressOf(player));
    const double due_s = std::min(player.dueIn(wallSeconds()), 0.02);
    std::this_thread::sleep_for(std::chrono::duration<double>(std::max(due_s, 0.001)));
  }
  console.say(progressOf(player));
  return 0;
}

PlannerReplay planFor(const ReplayOptions& options, const std::string& vehicle) {
  PlannerReplay plan;
  plan.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  plan.experiment_file =
      options.experiment_file.empty()
          ? (std::filesystem::path(options.log_file).parent_path() / "experiment.yaml").string()
          : options.experiment_file;
  if (!std::filesystem::exists(plan.experiment_file)) {
    throw core::StartupError(plan.experiment_file, "--experiment",
                             "the experiment file of the flight", "no such file");
  }
  plan.vehicle = vehicle;
  plan.policy = options.policy;
  plan.overrides = options.overrides;
  plan.speed = options.speed;
  plan.data_clock = options.play.data_clock;
  return plan;
}

int checkPlanner(const ReplayOptions& options) {
  constexpr std::string_view kPlanner = "planner:";
  if (!options.check.starts_with(kPlanner)) {
    throw core::StartupError("replay", "--check", "planner:VEHICLE", options.check);
  }
  const std::string vehicle = options.check.substr(kPlanner.size());
  const PlannerReplay plan = planFor(options, vehicle);
  const logs::EventLog log(options.log_file);
  const logs::Flight flight = logs::readFlight(options.log_file, plan.experiment_file);
  app::StopSignal stop;
  Console console;
  const auto again = replayToPlanner(plan, log, flight, stop, console);
  for (const logs::FlightVehicle& of : flight.vehicles) {
    if (of.name == vehicle) {
      const logs::CommandCheck check = logs::checkCommands(flight, of, again);
      std::string text = logs::toText(flight, of, check);
      text.pop_back();  // its last line's end
      console.say(text);
      return check.passed() ? 0 : 1;
    }
  }
  return 1;
}

int askPolicy(const ReplayOptions& options) {
  const logs::EventLog log(options.log_file);
  const logs::Flight flight =
      logs::readFlight(options.log_file, planFor(options, "").experiment_file);
  app::StopSignal stop;
  Console console;
  logs::makeFolder(options.folder);
  plot::GnuplotScript script;
  for (const logs::FlightVehicle& vehicle : flight.vehicles) {
    if (!options.vehicle.empty() && vehicle.name != options.vehicle) {
      continue;
    }
    const auto again = replayToPlanner(planFor(options, vehicle.name), log, flight, stop, console);
    const logs::CommandCheck check = logs::checkCommands(flight, vehicle, again);
    console.say(fmt::format("{}: {} would have commanded the same on {} of {} ticks", vehicle.name,
                            options.policy, check.equal(), check.pairs.size()));
    const std::string stem = (std::filesystem::path(options.folder) / vehicle.name).string();
    logs::Figure figure{"", "", stem + ".png", stem + ".svg"};
    logs::drawWhatIf(script, flight, vehicle, check, options.policy, figure);
  }
  if (script.text().empty()) {
    throw core::StartupError("replay", "--vehicle", "one of the log's", options.vehicle);
  }
  script.run();
  console.say("pictures in " + options.folder);
  return 0;
}

int replay(const ReplayOptions& options) {
  if (!options.check.empty()) {
    return checkPlanner(options);
  }
  return options.policy.empty() ? playLog(options) : askPolicy(options);
}

}  // namespace

void addReplayCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("replay", "Play a log, or check a planner against it");
  auto options = std::make_shared<ReplayOptions>();
  logs::PlayOptions& play = options->play;
  command->add_option("log", options->log_file, "LCM event log")->required();
  command->add_option("--speed", options->speed, "Times the pace of the log; checks: else lockstep")
      ->check(CLI::PositiveNumber);
  command->add_option("--from", play.from_s, "s since the first event")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--to", play.to_s, "s since the first event")->check(CLI::NonNegativeNumber);
  command->add_flag("--loop", play.loop, "Begins again at the end");
  command->add_flag("--paused", play.paused, "Waits for a key");
  command->add_flag("--data-clock", play.data_clock,
                    "Paced by the vehicle states' own time: for flights faster than real time");
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* help) {
    return command->add_option(name, values, help)->allow_extra_args(false)->take_all();
  };
  list("--channel", play.only, "Regular expression for whole names; repeatable");
  list("--without", play.except, "Channels to leave out; repeatable");
  list("--rename", options->renames, "Publishes on another channel; repeatable")
      ->type_name("OLD=NEW");
  command
      ->add_option("--check", options->check,
                   "Starts this planner, lets it hear the log, and compares its commands")
      ->type_name("planner:VEHICLE");
  command
      ->add_option("--policy", options->policy,
                   "What this policy would have done, as pictures; with --check: instead of "
                   "the experiment's")
      ->type_name("NAME[:WEIGHTS]");
  command->add_option("--vehicle", options->vehicle, "For --policy; default: all");
  command->add_option("-o,--out", options->folder, "Folder for pictures of --policy")
      ->capture_default_str();
  command->add_option("--experiment", options->experiment_file,
                      "Default: experiment.yaml beside the log");
  list("--set", options->overrides, "Overrides a key of the experiment, for planners; repeatable")
      ->type_name("KEY=VALUE");
  command->add_option("--lcm-url", options->lcm_url, "Default: LCM_DEFAULT_URL");
  command->callback([options, &exit_status] { exit_status = replay(*options); });
}

}  // namespace roundabout::cli
