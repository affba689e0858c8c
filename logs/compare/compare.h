#pragma once

#include <optional>
#include <string>
#include <vector>

#include "logs/flight.h"

namespace roundabout::logs {

/// Where one vehicle's two flights differ. Times are data time since each flight's first frame.
struct VehicleDifference {
  std::string vehicle;
  int frames = 0;                          ///< in which both saw it
  std::optional<double> states_part_at_s;  ///< further apart than the tolerance for the first time
  double furthest_m = 0.0;
  double furthest_at_s = 0.0;
  int commands = 0;  ///< that answer the same frame
  int equal_commands = 0;
  std::optional<double> commands_part_at_s;  ///< the first that are not equal to the last bit
  std::string first_command_difference;      ///< "velocity (0.50, 0.00) m/s, velocity (0.43, …"
};

struct FlightDifference {
  std::vector<VehicleDifference> vehicles;
  std::vector<std::string> only_in_a;  ///< vehicles
  std::vector<std::string> only_in_b;
  int frames_a = 0;
  int frames_b = 0;
  int frames_in_both = 0;  ///< at the same time since the first

  bool statesPart() const;
  bool commandsPart() const;
};

/// Frames and commands are those of the same time since the first frame, to the microsecond for
/// commands and to half a frame for states.
FlightDifference compareFlights(const Flight& a, const Flight& b, double tolerance_m);

std::string toText(const FlightDifference& difference, double tolerance_m);

/// "velocity (0.50, 0.00) m/s, height 1.00 m", for people.
std::string describe(const core::Command& command);

/// Every field but the time stamps is the same, to the last bit.
bool sameOrder(const core::Command& a, const core::Command& b);

}  // namespace roundabout::logs
