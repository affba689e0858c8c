#include "logs/metrics/motion.h"

#include <algorithm>

namespace roundabout::logs {

namespace {

constexpr double kPathStepM = 0.01;
constexpr core::Utime kAccelerationWindowUs = 200'000;
// Frames may be missing: a window may be this long and no longer.
constexpr core::Utime kLongestWindowUs = 300'000;

}  // namespace

double pathLength(const FlightVehicle& vehicle, std::size_t begin, std::size_t end) {
  double length_m = 0.0;
  const Sample* anchor = nullptr;
  for (std::size_t frame = begin; frame < end; ++frame) {
    const Sample& sample = vehicle.samples[frame];
    if (!sample.tracked) {
      continue;
    }
    if (anchor == nullptr) {
      anchor = &sample;
      continue;
    }
    const double step_m = (sample.position_world_m - anchor->position_world_m).head<2>().norm();
    if (step_m >= kPathStepM) {
      length_m += step_m;
      anchor = &sample;
    }
  }
  return length_m;
}

double maxSpeed(const Flight& flight, const FlightVehicle& vehicle) {
  double fastest_mps = 0.0;
  for (const Sample& sample : vehicle.samples) {
    if (flight.underWay(vehicle, sample)) {
      fastest_mps = std::max(fastest_mps, sample.velocity_world_mps.norm());
    }
  }
  return fastest_mps;
}

double maxAcceleration(const Flight& flight, const FlightVehicle& vehicle) {
  double largest_mps2 = 0.0;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < flight.frames.size(); ++begin) {
    while (end < flight.frames.size() &&
           flight.frames[end].utime - flight.frames[begin].utime < kAccelerationWindowUs) {
      ++end;
    }
    if (end == flight.frames.size()) {
      break;
    }
    const core::Utime window = flight.frames[end].utime - flight.frames[begin].utime;
    if (window <= kLongestWindowUs && flight.underWay(vehicle, vehicle.samples[begin]) &&
        flight.underWay(vehicle, vehicle.samples[end])) {
      const Eigen::Vector3d change =
          vehicle.samples[end].velocity_world_mps - vehicle.samples[begin].velocity_world_mps;
      largest_mps2 = std::max(largest_mps2, change.norm() / core::toSeconds(window));
    }
  }
  return largest_mps2;
}

}  // namespace roundabout::logs
