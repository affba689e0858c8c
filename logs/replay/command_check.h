#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "logs/flight.h"

namespace roundabout::logs {

/// A recorded command and what a planner that heard the same said.
struct CommandPair {
  core::Command recorded;
  std::optional<core::Command> again;  ///< nothing: it did not answer

  bool equal() const;
};

struct CommandCheck {
  std::vector<CommandPair> pairs;  ///< in the order of time
  int unasked = 0;  ///< recorded commands that answer no frame: sent during silence, or a kill
  int extra = 0;    ///< of the planner, at frames that no recorded command answers

  std::size_t equal() const;
  /// Index of the first pair that differs.
  std::optional<std::size_t> firstDifference() const;
  bool passed() const { return !pairs.empty() && !firstDifference() && extra == 0; }
};

/// again: by state_utime.
CommandCheck checkCommands(const Flight& flight, const FlightVehicle& vehicle,
                           const std::map<core::Utime, core::Command>& again);

/// How many are equal, and the first difference with the states around it.
std::string toText(const Flight& flight, const FlightVehicle& vehicle, const CommandCheck& check);

/// utimes of frames that the vehicle's planner answered with a command of that time.
std::vector<core::Utime> answeredFrames(const Flight& flight, const FlightVehicle& vehicle);

}  // namespace roundabout::logs
