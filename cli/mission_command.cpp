#include "cli/mission_command.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "cli/console.h"
#include "cli/order_delivery.h"
#include "cli/wall_clock.h"
#include "common/app/stop_signal.h"
#include "common/bus/lcm_bus.h"
#include "common/bus/messages.h"
#include "common/bus/typed.h"
#include "common/config/experiment_file.h"
#include "common/core/error.h"
#include "common/core/fleet_phase.h"
#include "roundabout_msgs/fleet_status_t.hpp"
#include "roundabout_msgs/mission_t.hpp"

namespace roundabout::cli {

namespace {

using roundabout_msgs::fleet_status_t;
using std::chrono::milliseconds;

// The fleet answers at 5 Hz: this is several chances.
constexpr double kAnswerLimit_s = 1.5;

struct MissionOptions {
  config::MissionStep step;
  std::vector<double> point_m;
  std::vector<std::string> points;
  std::string event;
  std::string file;
  bool follow = false;
  std::string lcm_url;
};

/// The fleet as heard.
class FleetLine {
 public:
  explicit FleetLine(const std::string& lcm_url) : url_(bus::resolveUrl(lcm_url)), bus_(url_) {
    bus::subscribe<fleet_status_t>(
        bus_, bus::kFleetStatusChannel,
        [this](const fleet_status_t& status) {
          status_ = status;
          ++heard_;
          last_heard_s_ = wallSeconds();
        },
        [](const bus::DecodeError&) {});
  }

  void listen(milliseconds time) { bus_.handle(time); }
  bool heard() const { return heard_ > 0; }
  int count() const { return heard_; }
  double silenceS() const { return wallSeconds() - last_heard_s_; }
  const fleet_status_t& status() const { return status_; }
  bus::LcmBus& bus() { return bus_; }
  const std::string& url() const { return url_; }

  /// Empty: not refused, as far as is known.
  std::string refusal(std::int64_t mission) const {
    const std::string prefix = fmt::format("mission {}: ", mission);
    for (const std::string& line : status_.refusals) {
      if (line.starts_with(prefix)) {
        return line.substr(prefix.size());
      }
    }
    return "";
  }

  /// True once the fleet has taken or refused it.
  bool waitUntilTaken(std::int64_t mission) {
    const double since_s = wallSeconds();
    while (wallSeconds() - since_s < kAnswerLimit_s) {
      listen(milliseconds(20));
      if (heard() && (status_.newest_mission_id >= mission || !refusal(mission).empty())) {
        return true;
      }
    }
    return false;
  }

 private:
  std::string url_;
  bus::LcmBus bus_;
  fleet_status_t status_{};
  int heard_ = 0;
  double last_heard_s_ = wallSeconds();
};

roundabout_msgs::mission_t toMessage(const config::MissionStep& step, std::int64_t id) {
  roundabout_msgs::mission_t message;
  message.utime = id;
  message.mission_id = id;
  message.verb = step.verb;
  message.text = step.text;
  message.vehicle = step.vehicle;
  message.seconds = step.seconds < 0.0 ? std::numeric_limits<double>::quiet_NaN() : step.seconds;
  for (const Eigen::Vector3d& point : step.points_m) {
    message.points.push_back({point.x(), point.y(), point.z()});
  }
  message.num_points = static_cast<std::int32_t>(message.points.size());
  return message;
}

/// "1,2,1": metres.
Eigen::Vector3d pointOf(const std::string& text) {
  Eigen::Vector3d point_m;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    const auto [rest, error] = std::from_chars(at, end, point_m[i]);
    if (error != std::errc() || (i < 2 ? rest == end || *rest != ',' : rest != end)) {
      throw core::StartupError("mission formation", "points", "x,y,z (metres, no blanks)", text);
    }
    at = rest + 1;
  }
  return point_m;
}

/// What wait_until waits for: a word, or seconds since the take-off.
void setEvent(config::MissionStep& step, const std::string& event) {
  const char* const end = event.data() + event.size();
  const auto [rest, error] = std::from_chars(event.data(), end, step.seconds);
  if (error != std::errc() || rest != end) {
    step.seconds = -1.0;
    step.text = event;
  }
}

std::string lineOf(const fleet_status_t& status) {
  std::string line = fmt::format("{}{}{}", nameOf(static_cast<core::FleetPhase>(status.phase)),
                                 status.formation.empty() ? "" : " ", status.formation);
  if (status.num_vehicles > 0) {
    line += fmt::format(", {} of {} at their goals", status.vehicles_at_goal, status.num_vehicles);
  }
  if (status.num_steps > 0 && status.step >= 0) {
    line += fmt::format(", step {} of {}", status.step + 1, status.num_steps);
  }
  return status.reason.empty() ? line : line + ": " + status.reason;
}

int complain(const FleetLine& fleet, const std::string& text) {
  fmt::print(stderr, "roundabout: {}: {}\n", fleet.url(), text);
  return 1;
}

/// Prints what changes until the mission is done; 0: until the user stops.
int follow(FleetLine& fleet, std::int64_t mission) {
  constexpr double kSilent_s = 3.0;
  app::StopSignal stop;
  std::string said;
  while (!stop.requested()) {
    fleet.listen(milliseconds(50));
    if (!fleet.heard() && fleet.silenceS() < kSilent_s) {
      continue;
    }
    if (fleet.silenceS() > kSilent_s) {
      return complain(fleet, "the fleet is not heard");
    }
    if (const std::string line = lineOf(fleet.status()); line != said) {
      said = line;
      fmt::print("{}\n", line);
      std::fflush(stdout);
    }
    if (mission == 0) {
      continue;
    }
    if (const std::string refusal = fleet.refusal(mission); !refusal.empty()) {
      return complain(fleet, "refused: " + refusal);
    }
    if (fleet.status().phase == fleet_status_t::FAILED) {
      return complain(fleet, "failed: " + fleet.status().reason);
    }
    if (fleet.status().finished_mission_id >= mission) {
      return 0;
    }
    if (fleet.status().newest_mission_id < mission) {
      return complain(fleet, "the fleet was restarted and forgot the mission");
    }
  }
  return 130;
}

/// Sends steps one after the other; each has to be taken before the next goes out, and hold and
/// land, which take effect at once, wait until what is before them is done.
int send(FleetLine& fleet, const std::vector<config::MissionStep>& steps, std::int64_t& last) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool at_once = steps[i].verb == "hold" || steps[i].verb == "land";
    if (const int status = i > 0 && at_once ? follow(fleet, last) : 0; status != 0) {
      return status;
    }
    last = std::max(wallTime(), last + 1);
    bus::publish(fleet.bus(), bus::kMissionChannel, toMessage(steps[i], last));
    const bool taken = fleet.waitUntilTaken(last);
    const std::string where =
        steps.size() == 1 ? "" : fmt::format("step {} ({}): ", i + 1, steps[i].verb);
    if (!fleet.heard()) {
      return complain(fleet, "no fleet is heard");
    }
    if (!fleet.refusal(last).empty()) {
      return complain(fleet, where + "refused: " + fleet.refusal(last));
    }
    if (!taken) {
      return complain(fleet, where + "the fleet does not take it");
    }
  }
  return 0;
}

int sendSteps(const MissionOptions& options, const std::vector<config::MissionStep>& steps) {
  standWithoutTerminal();
  FleetLine fleet(options.lcm_url);
  std::int64_t last = 0;
  const int status = send(fleet, steps, last);
  return status != 0 || !options.follow ? status : follow(fleet, last);
}

int showStatus(const MissionOptions& options) {
  standWithoutTerminal();
  FleetLine fleet(options.lcm_url);
  if (options.follow) {
    return follow(fleet, 0);
  }
  for (const double since_s = wallSeconds(); !fleet.heard();) {
    fleet.listen(milliseconds(50));
    if (wallSeconds() - since_s > kAnswerLimit_s) {
      return complain(fleet, "no fleet is heard");
    }
  }
  fmt::print("{}\n", lineOf(fleet.status()));
  for (const auto& vehicle : fleet.status().vehicles) {
    const std::string goal =
        std::isnan(vehicle.distance)
            ? "no goal"
            : fmt::format("goal ({:.2f}, {:.2f}, {:.2f}) m, {:.2f} m to go", vehicle.goal[0],
                          vehicle.goal[1], vehicle.goal[2], vehicle.distance);
    fmt::print("  {:<12} {}{}{}\n", vehicle.vehicle, goal, vehicle.at_goal != 0 ? ", there" : "",
               vehicle.planner_alive != 0 ? "" : ", no planner");
  }
  return 0;
}

int kill(const MissionOptions& options) {
  bus::LcmBus bus(bus::resolveUrl(options.lcm_url));
  core::SafetyOrder order;
  order.utime = wallTime();
  order.vehicle = options.step.vehicle;
  order.order = core::SafetyOrderKind::kKill;
  const Delivery delivery = deliver(bus, order);
  for (const std::string& line : delivery.obeyed) {
    fmt::print("{}\n", line);
  }
  for (const std::string& line : delivery.problems) {
    fmt::print(stderr, "roundabout: {}\n", line);
  }
  return delivery.complete() ? 0 : 1;
}

}  // namespace

void addMissionCommand(CLI::App& app, int& exit_status) {
  CLI::App* mission = app.add_subcommand("mission", "Give the fleet steps to fly");
  mission->require_subcommand(1);
  auto options = std::make_shared<MissionOptions>();
  const auto add = [&](const char* name, const char* help) {
    CLI::App* command = mission->add_subcommand(name, help);
    command->add_option("--lcm-url", options->lcm_url, "Default: LCM_DEFAULT_URL");
    return command;
  };
  const auto verb = [&, options](const char* name, const char* help) {
    CLI::App* command = add(name, help);
    command->add_flag("--follow", options->follow, "Says what changes until it is done");
    command->callback([options, name, &exit_status] {
      for (const std::string& point : options->points) {
        options->step.points_m.push_back(pointOf(point));
      }
      if (!options->event.empty()) {
        setEvent(options->step, options->event);
      }
      options->step.verb = name;
      if (!options->point_m.empty()) {
        options->step.points_m = {Eigen::Vector3d(options->point_m.data())};
      }
      exit_status = sendSteps(*options, {options->step});
    });
    return command;
  };
  verb("take_off", "Everybody climbs above its place");
  const auto staying = [options](CLI::App* command) {
    command->add_option("--seconds", options->step.seconds, "To stay; default: fleet.hold_s")
        ->check(CLI::NonNegativeNumber);
    return command;
  };
  staying(verb("spell", "Letter by letter"))
      ->add_option("text", options->step.text, "What to spell")
      ->required();
  CLI::App* formation = staying(verb("formation", "A vehicle goes to each point"));
  formation->add_option("points", options->points, "x,y,z each, m, world; no blanks within")
      ->required();
  formation->add_option("--name", options->step.text, "Shown while it is flown");
  CLI::App* go_to = verb("go_to", "One vehicle goes to a point");
  go_to->add_option("vehicle", options->step.vehicle, "Which")->required();
  go_to->add_option("point", options->point_m, "x y z, m, world")->required()->expected(3);
  verb("wait", "Nothing changes for a while")
      ->add_option("seconds", options->step.seconds, "s of data time")
      ->required();
  verb("wait_until", "Nothing changes until something is so")
      ->add_option("what", options->event, "formed, go_on, or seconds since the take-off began")
      ->required();
  add("go_on", "Ends a wait_until go_on")->callback([options, &exit_status] {
    options->step.verb = "go_on";
    exit_status = sendSteps(*options, {options->step});
  });
  verb("hold", "Everybody stays, at once; what is queued is dropped");
  verb("land", "Everybody descends where it is, at once; what is queued is dropped");

  CLI::App* kill_command = add("kill", "Motors off, now; as `order kill`");
  kill_command->add_option("--vehicle", options->step.vehicle, "Default: all");
  kill_command->callback([options, &exit_status] { exit_status = kill(*options); });

  CLI::App* status = add("status", "What the fleet is doing");
  status->add_flag("--follow", options->follow, "Goes on, a line for whatever changes");
  status->callback([options, &exit_status] { exit_status = showStatus(*options); });

  CLI::App* send_command = add("send", "A file with a mission, step by step");
  send_command->add_option("file", options->file, "YAML with the one key `mission`")->required();
  send_command->add_flag("--follow", options->follow, "Says what changes until it is done");
  send_command->callback([options, &exit_status] {
    exit_status = sendSteps(*options, config::readMissionFile(options->file));
  });
}

}  // namespace roundabout::cli
