#include "logs/replay/command_check.h"

#include <algorithm>
#include <set>

#include <spdlog/fmt/fmt.h>

#include "logs/compare/compare.h"

namespace roundabout::logs {

namespace {

bool isFrame(const Flight& flight, core::Utime utime) {
  const std::size_t frame = flight.frameAt(utime);
  return frame < flight.frames.size() && flight.frames[frame].utime == utime;
}

/// Sent because of a frame, and not because none came.
bool answersItsFrame(const Flight& flight, const core::Command& command) {
  return command.utime == command.state_utime && isFrame(flight, command.state_utime);
}

const PlannerStatus* statusAt(const FlightVehicle& vehicle, core::Utime utime) {
  const auto found = std::find_if(vehicle.statuses.begin(), vehicle.statuses.end(),
                                  [&](const auto& status) { return status.value.utime == utime; });
  return found == vehicle.statuses.end() ? nullptr : &found->value;
}

std::string statesAround(const Flight& flight, const FlightVehicle& own, core::Utime utime) {
  std::string text;
  const std::size_t at = flight.frameAt(utime);
  const std::size_t first = at - std::min<std::size_t>(at, 1);
  for (std::size_t frame = first; frame < std::min(at + 2, flight.frames.size()); ++frame) {
    text += fmt::format("  frame {} at {:.3f} s\n", flight.frames[frame].number,
                        flight.secondsAt(flight.frames[frame].utime));
    for (const FlightVehicle& vehicle : flight.vehicles) {
      const Sample& sample = vehicle.samples[frame];
      const Eigen::Vector3d& at_m = sample.position_world_m;
      const Eigen::Vector3d& velocity = sample.velocity_world_mps;
      text += sample.tracked ? fmt::format(
                                   "  {} {:<12} ({:8.4f}, {:8.4f}, {:7.4f}) m  ({:7.4f}, {:7.4f}, "
                                   "{:7.4f}) m/s\n",
                                   &vehicle == &own ? '*' : ' ', vehicle.name, at_m.x(), at_m.y(),
                                   at_m.z(), velocity.x(), velocity.y(), velocity.z())
                             : fmt::format("  {} {:<12} not tracked\n",
                                           &vehicle == &own ? '*' : ' ', vehicle.name);
    }
  }
  return text;
}

std::string goalAt(const FlightVehicle& vehicle, core::Utime utime) {
  std::string text = "no goal yet";
  for (const auto& goal : vehicle.goals) {
    if (goal.value.utime < utime) {
      const Eigen::Vector3d& at_m = goal.value.position_world_m;
      text = fmt::format("goal {} at ({:.3f}, {:.3f}, {:.3f}) m", goal.value.goal_id, at_m.x(),
                         at_m.y(), at_m.z());
    }
  }
  return text;
}

}  // namespace

bool CommandPair::equal() const { return again.has_value() && sameOrder(recorded, *again); }

std::size_t CommandCheck::equal() const {
  return static_cast<std::size_t>(std::count_if(
      pairs.begin(), pairs.end(), [](const CommandPair& pair) { return pair.equal(); }));
}

std::optional<std::size_t> CommandCheck::firstDifference() const {
  const auto found = std::find_if(pairs.begin(), pairs.end(),
                                  [](const CommandPair& pair) { return !pair.equal(); });
  return found == pairs.end() ? std::nullopt
                              : std::optional(static_cast<std::size_t>(found - pairs.begin()));
}

std::vector<core::Utime> answeredFrames(const Flight& flight, const FlightVehicle& vehicle) {
  std::vector<core::Utime> utimes;
  for (const auto& command : vehicle.commands) {
    if (answersItsFrame(flight, command.value)) {
      utimes.push_back(command.value.state_utime);
    }
  }
  return utimes;
}

CommandCheck checkCommands(const Flight& flight, const FlightVehicle& vehicle,
                           const std::map<core::Utime, core::Command>& again) {
  CommandCheck check;
  std::set<core::Utime> recorded;
  for (const auto& command : vehicle.commands) {
    if (!answersItsFrame(flight, command.value)) {
      ++check.unasked;
      continue;
    }
    if (!recorded.insert(command.value.state_utime).second) {
      continue;
    }
    const auto answer = again.find(command.value.state_utime);
    check.pairs.push_back(
        {command.value, answer == again.end() ? std::nullopt : std::optional(answer->second)});
  }
  for (const auto& [utime, command] : again) {
    check.extra += recorded.contains(utime) ? 0 : 1;
  }
  return check;
}

std::string toText(const Flight& flight, const FlightVehicle& vehicle, const CommandCheck& check) {
  std::string text =
      fmt::format("{}: {} of {} commands equal", vehicle.name, check.equal(), check.pairs.size());
  text += check.unasked == 0
              ? ""
              : fmt::format("; {} that answer no frame are not repeated", check.unasked);
  text += check.extra == 0 ? "\n" : fmt::format("; {} that were not recorded\n", check.extra);
  const auto first = check.firstDifference();
  if (!first) {
    return text;
  }
  const CommandPair& pair = check.pairs[*first];
  const core::Utime utime = pair.recorded.state_utime;
  text += fmt::format("first difference: command {} of {}, at {:.3f} s\n", *first + 1,
                      check.pairs.size(), flight.secondsAt(utime));
  text += fmt::format("  recorded: {}\n", describe(pair.recorded));
  text += fmt::format("  again:    {}\n", pair.again ? describe(*pair.again) : "no answer");
  if (const PlannerStatus* status = statusAt(vehicle, utime)) {
    text += fmt::format("  then: {}{}{}, {}\n", nameOf(status->mode),
                        status->reason.empty() ? "" : ": ", status->reason, goalAt(vehicle, utime));
  }
  return text + statesAround(flight, vehicle, utime);
}

}  // namespace roundabout::logs
