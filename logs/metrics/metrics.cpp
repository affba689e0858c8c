#include "logs/metrics/metrics.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "logs/metrics/faults.h"
#include "logs/metrics/formations.h"
#include "logs/metrics/obstacles.h"
#include "logs/metrics/people.h"
#include "logs/metrics/separation.h"
#include "logs/metrics/timing.h"
#include "logs/metrics/vehicles.h"

namespace roundabout::logs {

namespace {

std::string whoIsMissing(const FormationMetrics& formation) {
  std::string names;
  for (const LegMetrics& leg : formation.legs) {
    if (!leg.reached) {
      names += (names.empty() ? "" : ", ") + leg.vehicle;
    }
  }
  return names.empty() ? names : fmt::format(": {} did not reach the goal", names);
}

std::vector<std::string> failuresOf(const Flight& flight, const Metrics& metrics) {
  std::vector<std::string> failures;
  if (flight.frames.empty()) {
    failures.emplace_back("the log holds no VEHICLE_STATES");
  }
  for (const Encounter& touch : metrics.separation.touches) {
    failures.push_back(fmt::format("the bodies of {} and {} touched at {:.1f} s (overlap {:.2f} m)",
                                   touch.vehicle_a, touch.vehicle_b, touch.begin_at_s,
                                   -touch.closest_gap_m));
  }
  for (const ClosestGap& touch : metrics.obstacles.touches) {
    failures.push_back(
        fmt::format("the body of {} touched obstacle {} at {:.1f} s (overlap {:.2f} m)",
                    touch.vehicle_a, touch.vehicle_b, touch.at_s, -touch.gap_m));
  }
  for (const ClosestGap& touch : metrics.people.touches) {
    failures.push_back(fmt::format("the bodies of {} and {} touched at {:.1f} s", touch.vehicle_a,
                                   touch.vehicle_b, touch.at_s));
  }
  for (const auto* stretches : {&metrics.separation.unseen, &metrics.obstacles.unseen}) {
    for (const Unseen& unseen : *stretches) {
      failures.push_back(fmt::format(
          "cannot tell whether bodies touched: {} unseen {:.1f}-{:.1f} s near {}", unseen.vehicle,
          unseen.begin_at_s, unseen.end_at_s, fmt::join(unseen.near, ", ")));
    }
  }
  for (const FormationMetrics& formation : metrics.formations) {
    if (!formation.formed) {
      failures.push_back(formation.name + " was not formed" + whoIsMissing(formation));
    }
  }
  if (metrics.phases.empty()) {
    failures.emplace_back("the log holds no FLEET_STATUS: nobody said what was to be formed");
    return failures;
  }
  const auto last_heard =
      std::find_if(flight.fleet.rbegin(), flight.fleet.rend(),
                   [](const Logged<FleetStatus>& status) { return status.value.utime > 0; });
  const FleetStatus& last = last_heard->value;
  if (last.phase == FleetPhase::kIdle && last.step + 1 < last.num_steps) {
    failures.push_back(
        fmt::format("the mission was left at step {} of {}", last.step + 1, last.num_steps));
  } else if (last.phase != FleetPhase::kIdle && last.phase != FleetPhase::kDone) {
    failures.push_back(fmt::format("the flight ended in phase {}{}", nameOf(last.phase),
                                   last.reason.empty() ? "" : ": " + last.reason));
  }
  return failures;
}

}  // namespace

int Metrics::formationsFormed() const {
  return static_cast<int>(
      std::count_if(formations.begin(), formations.end(),
                    [](const FormationMetrics& formation) { return formation.formed; }));
}

Metrics computeMetrics(const Flight& flight) {
  Metrics metrics;
  metrics.timing = timingOf(flight);
  metrics.separation = separationOf(flight);
  metrics.obstacles = obstaclesOf(flight);
  metrics.people = peopleOf(flight);
  metrics.phases = phasesOf(flight);
  metrics.formations =
      formationsOf(flight, metrics.phases, gapsOverTime(flight), metrics.separation);
  for (const FlightVehicle& vehicle : flight.vehicles) {
    metrics.vehicles.push_back(vehicleMetricsOf(flight, vehicle));
  }
  metrics.faults = faultsOf(flight, metrics.phases, metrics.timing.nominal_interval_s);
  metrics.failures = failuresOf(flight, metrics);
  metrics.success = metrics.failures.empty();
  return metrics;
}

}  // namespace roundabout::logs
