#include "logs/compare/compare.h"

#include <algorithm>
#include <bit>
#include <map>

#include <spdlog/fmt/fmt.h>

namespace roundabout::logs {

namespace {

/// Frame of b for each frame of a: the nearest in time, if it is nearer than half a frame.
class FramePairs {
 public:
  FramePairs(const Flight& a, const Flight& b) {
    for (std::size_t i = 0; i < a.frames.size(); ++i) {
      const core::Utime since = a.frames[i].utime - a.frames.front().utime;
      if (b.frames.empty()) {
        break;
      }
      const core::Utime wanted = b.frames.front().utime + since;
      std::size_t j = b.frameAt(wanted);
      if (j > 0 &&
          (j == b.frames.size() || wanted - b.frames[j - 1].utime < b.frames[j].utime - wanted)) {
        --j;
      }
      if (2 * std::abs(b.frames[j].utime - wanted) < intervalBefore(a, i)) {
        pairs_.emplace_back(i, j);
      }
    }
  }

  const std::vector<std::pair<std::size_t, std::size_t>>& all() const { return pairs_; }

 private:
  static core::Utime intervalBefore(const Flight& flight, std::size_t frame) {
    constexpr core::Utime kLongest = 20'000;
    return frame == 0
               ? kLongest
               : std::min(kLongest, flight.frames[frame].utime - flight.frames[frame - 1].utime);
  }

  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
};

void compareStates(const Flight& flight_a, const FlightVehicle& a, const FlightVehicle& b,
                   const FramePairs& pairs, double tolerance_m, VehicleDifference& difference) {
  for (const auto& [i, j] : pairs.all()) {
    const Sample& in_a = a.samples[i];
    const Sample& in_b = b.samples[j];
    if (!in_a.tracked || !in_b.tracked) {
      continue;
    }
    ++difference.frames;
    const double apart_m = (in_a.position_world_m - in_b.position_world_m).norm();
    const double at_s = flight_a.secondsAt(flight_a.frames[i].utime);
    if (apart_m > difference.furthest_m) {
      difference.furthest_m = apart_m;
      difference.furthest_at_s = at_s;
    }
    if (apart_m > tolerance_m && !difference.states_part_at_s) {
      difference.states_part_at_s = at_s;
    }
  }
}

std::map<core::Utime, const core::Command*> commandsByAge(const Flight& flight,
                                                          const FlightVehicle& vehicle) {
  std::map<core::Utime, const core::Command*> commands;
  for (const auto& command : vehicle.commands) {
    if (command.value.state_utime > 0 && !flight.frames.empty()) {
      commands.emplace(command.value.state_utime - flight.frames.front().utime, &command.value);
    }
  }
  return commands;
}

void compareCommands(const Flight& flight_a, const FlightVehicle& a, const Flight& flight_b,
                     const FlightVehicle& b, VehicleDifference& difference) {
  const auto in_b = commandsByAge(flight_b, b);
  for (const auto& [age, command] : commandsByAge(flight_a, a)) {
    const auto other = in_b.find(age);
    if (other == in_b.end()) {
      continue;
    }
    ++difference.commands;
    if (sameOrder(*command, *other->second)) {
      ++difference.equal_commands;
    } else if (!difference.commands_part_at_s) {
      difference.commands_part_at_s = core::toSeconds(age);
      difference.first_command_difference =
          fmt::format("{} | {}", describe(*command), describe(*other->second));
    }
  }
}

std::string timeOr(const std::optional<double>& time_s, const char* otherwise) {
  return time_s ? fmt::format("{:.3f} s", *time_s) : otherwise;
}

const FlightVehicle* find(const Flight& flight, const std::string& name) {
  const auto found = std::find_if(flight.vehicles.begin(), flight.vehicles.end(),
                                  [&](const auto& vehicle) { return vehicle.name == name; });
  return found == flight.vehicles.end() ? nullptr : &*found;
}

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return same(a.x(), b.x()) && same(a.y(), b.y()) && same(a.z(), b.z());
}

}  // namespace

bool FlightDifference::statesPart() const {
  return std::any_of(vehicles.begin(), vehicles.end(),
                     [](const auto& vehicle) { return vehicle.states_part_at_s.has_value(); });
}

bool FlightDifference::commandsPart() const {
  return std::any_of(vehicles.begin(), vehicles.end(),
                     [](const auto& vehicle) { return vehicle.commands_part_at_s.has_value(); });
}

bool sameOrder(const core::Command& a, const core::Command& b) {
  return a.mode == b.mode && same(a.velocity_world_mps, b.velocity_world_mps) &&
         same(a.position_world_m, b.position_world_m) &&
         same(a.heading_world_rad, b.heading_world_rad) &&
         same(a.heading_rate_radps, b.heading_rate_radps) && same(a.valid_for_s, b.valid_for_s);
}

std::string describe(const core::Command& command) {
  const Eigen::Vector3d& velocity = command.velocity_world_mps;
  const Eigen::Vector3d& position = command.position_world_m;
  std::string text;
  switch (command.mode) {
    case core::CommandMode::kVelocity:
      text = fmt::format("velocity ({:.4g}, {:.4g}) m/s at {:.4g} m", velocity.x(), velocity.y(),
                         position.z());
      break;
    case core::CommandMode::kPosition:
      text = fmt::format("position ({:.4g}, {:.4g}, {:.4g}) m", position.x(), position.y(),
                         position.z());
      break;
    case core::CommandMode::kHold:
      text = "hold";
      break;
    case core::CommandMode::kLand:
      text = "land";
      break;
    case core::CommandMode::kKill:
      text = "kill";
      break;
  }
  return text + fmt::format(", heading {:.4g} rad, valid {:.4g} s", command.heading_world_rad,
                            command.valid_for_s);
}

FlightDifference compareFlights(const Flight& a, const Flight& b, double tolerance_m) {
  FlightDifference difference;
  difference.frames_a = static_cast<int>(a.frames.size());
  difference.frames_b = static_cast<int>(b.frames.size());
  const FramePairs pairs(a, b);
  difference.frames_in_both = static_cast<int>(pairs.all().size());
  for (const FlightVehicle& vehicle : a.vehicles) {
    const FlightVehicle* other = find(b, vehicle.name);
    if (other == nullptr) {
      difference.only_in_a.push_back(vehicle.name);
      continue;
    }
    VehicleDifference& of = difference.vehicles.emplace_back();
    of.vehicle = vehicle.name;
    compareStates(a, vehicle, *other, pairs, tolerance_m, of);
    compareCommands(a, vehicle, b, *other, of);
  }
  for (const FlightVehicle& vehicle : b.vehicles) {
    if (find(a, vehicle.name) == nullptr) {
      difference.only_in_b.push_back(vehicle.name);
    }
  }
  return difference;
}

std::string toText(const FlightDifference& difference, double tolerance_m) {
  std::string text =
      fmt::format("{} frames in A, {} in B, {} at the same time since the first\n",
                  difference.frames_a, difference.frames_b, difference.frames_in_both);
  for (const std::string& name : difference.only_in_a) {
    text += name + " is in A only\n";
  }
  for (const std::string& name : difference.only_in_b) {
    text += name + " is in B only\n";
  }
  text += fmt::format("\n{:<12} {:>18} {:>12} {:>12} {:>18} {:>16}\n", "vehicle",
                      fmt::format("states part (> {:g} m)", tolerance_m), "furthest m", "at s",
                      "commands part", "equal commands");
  for (const VehicleDifference& vehicle : difference.vehicles) {
    text += fmt::format("{:<12} {:>18} {:>12.4f} {:>12.3f} {:>18} {:>16}\n", vehicle.vehicle,
                        timeOr(vehicle.states_part_at_s, "never"), vehicle.furthest_m,
                        vehicle.furthest_at_s, timeOr(vehicle.commands_part_at_s, "never"),
                        fmt::format("{} of {}", vehicle.equal_commands, vehicle.commands));
  }
  for (const VehicleDifference& vehicle : difference.vehicles) {
    if (vehicle.commands_part_at_s) {
      text += fmt::format("\n{} at {:.3f} s: {}", vehicle.vehicle, *vehicle.commands_part_at_s,
                          vehicle.first_command_difference);
    }
  }
  if (difference.commandsPart()) {
    text += '\n';
  }
  return text;
}

}  // namespace roundabout::logs
