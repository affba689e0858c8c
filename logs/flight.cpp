#include "logs/flight.h"

#include <algorithm>
#include <cmath>

namespace roundabout::logs {

namespace {

// Data and wall clock of a flight in real time differ by the clocks' drift and by start and end.
constexpr double kRealTimeTolerance = 0.02;

}  // namespace

double Flight::secondsAt(core::Utime utime) const {
  return frames.empty() ? 0.0 : core::toSeconds(utime - frames.front().utime);
}

core::Utime Flight::utimeAt(double seconds) const {
  return (frames.empty() ? 0 : frames.front().utime) + core::toUtime(seconds);
}

std::size_t Flight::frameAt(core::Utime utime) const {
  const auto found =
      std::lower_bound(frames.begin(), frames.end(), utime,
                       [](const Frame& frame, core::Utime wanted) { return frame.utime < wanted; });
  return static_cast<std::size_t>(found - frames.begin());
}

core::Utime Flight::dataTimeOf(core::Utime log_utime) const {
  if (frames.empty()) {
    return 0;
  }
  const auto after = std::upper_bound(
      frames.begin(), frames.end(), log_utime,
      [](core::Utime wanted, const Frame& frame) { return wanted < frame.log_utime; });
  return after == frames.begin() ? frames.front().utime : std::prev(after)->utime;
}

bool Flight::realTime() const {
  if (experiment) {
    return experiment->source != "sim" || experiment->sim.pacing == "real_time";
  }
  if (frames.size() < 2) {
    return false;
  }
  const auto data = static_cast<double>(frames.back().utime - frames.front().utime);
  const auto wall = static_cast<double>(frames.back().log_utime - frames.front().log_utime);
  return std::abs(data - wall) <= kRealTimeTolerance * data;
}

bool Flight::underWay(const FlightVehicle& vehicle, const Sample& sample) const {
  return sample.tracked && (!vehicle.flies || sample.position_world_m.z() > airborne_height_m);
}

}  // namespace roundabout::logs
