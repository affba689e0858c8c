#include "logs/metrics/vehicles.h"

#include <algorithm>
#include <array>

#include "logs/metrics/motion.h"

namespace roundabout::logs {

namespace {

using core::ShieldLayer;

/// Sums a counter that starts again from zero when its process does.
class RestartingCounter {
 public:
  void see(int value) {
    total_ += value >= last_ ? value - last_ : value;
    last_ = value;
  }
  int total() const { return total_; }

 private:
  int last_ = 0;
  int total_ = 0;
};

double untrackedTime(const Flight& flight, const FlightVehicle& vehicle) {
  core::Utime total = 0;
  for (std::size_t frame = 0; frame + 1 < flight.frames.size(); ++frame) {
    if (!vehicle.samples[frame].tracked) {
      total += flight.frames[frame + 1].utime - flight.frames[frame].utime;
    }
  }
  return core::toSeconds(total);
}

void addCommands(const Flight& flight, const FlightVehicle& vehicle, VehicleMetrics& metrics) {
  std::vector<double> latencies_s;
  core::Utime first = 0;
  core::Utime last = 0;
  for (const Logged<core::Command>& command : vehicle.commands) {
    if (command.value.utime <= last) {
      continue;
    }
    last = command.value.utime;
    first = first == 0 ? last : first;
    ++metrics.commands;
    const std::size_t frame = flight.frameAt(command.value.state_utime);
    if (frame < flight.frames.size() && flight.frames[frame].utime == command.value.state_utime) {
      latencies_s.push_back(core::toSeconds(command.log_utime - flight.frames[frame].log_utime));
    }
  }
  if (metrics.commands > 1) {
    metrics.command_rate_hz = (metrics.commands - 1) / core::toSeconds(last - first);
  }
  metrics.command_latency_s = spreadOf(std::move(latencies_s));
}

/// A status that is said again is no new step.
void addStep(const PlannerStatus& status, const PlannerStatus* before, ShieldMetrics& shield) {
  const bool repeated = before != nullptr && status.utime <= before->utime;
  if (repeated || status.shield_layer < ShieldLayer::kNone) {
    return;
  }
  ++shield.steps;
  shield.smallest_predicted_gap_m =
      std::min(shield.smallest_predicted_gap_m, status.predicted_gap_m);
  if (status.shield_layer == ShieldLayer::kNone) {
    return;
  }
  const auto place =
      std::lower_bound(shield.by_layer.begin(), shield.by_layer.end(), status.shield_layer,
                       [](const auto& entry, ShieldLayer layer) { return entry.first < layer; });
  if (place == shield.by_layer.end() || place->first != status.shield_layer) {
    shield.by_layer.insert(place, {status.shield_layer, 1});
  } else {
    ++place->second;
  }
}

void addStatuses(const FlightVehicle& vehicle, VehicleMetrics& metrics) {
  std::array<double, static_cast<std::size_t>(PlannerMode::kKilled) + 1> time_in_mode_s{};
  std::vector<double> compute_times_s;
  RestartingCounter interventions;
  RestartingCounter messages;
  RestartingCounter measurements;
  RestartingCounter ticks;
  const PlannerStatus* before = nullptr;
  for (const Logged<PlannerStatus>& entry : vehicle.statuses) {
    const PlannerStatus& status = entry.value;
    interventions.see(status.shield_interventions);
    messages.see(status.rejected_messages);
    measurements.see(status.rejected_measurements);
    ticks.see(status.missed_ticks);
    metrics.policy = status.policy;
    if (status.utime == 0) {
      continue;
    }
    if (status.mode == PlannerMode::kFlying) {
      compute_times_s.push_back(status.compute_time_s);
    }
    addStep(status, before, metrics.shield);
    if (before != nullptr) {
      const double passed_s = core::toSeconds(status.utime - before->utime);
      const auto mode = static_cast<std::size_t>(before->mode);
      if (passed_s > 0.0 && passed_s <= kSilenceS && mode < time_in_mode_s.size()) {
        time_in_mode_s[mode] += passed_s;
      }
    }
    before = &status;
  }
  for (std::size_t mode = 0; mode < time_in_mode_s.size(); ++mode) {
    if (time_in_mode_s[mode] > 0.0) {
      metrics.time_in_mode_s.emplace_back(static_cast<PlannerMode>(mode), time_in_mode_s[mode]);
    }
  }
  metrics.compute_time_s = spreadOf(std::move(compute_times_s));
  metrics.shield.interventions = interventions.total();
  metrics.rejected_messages = messages.total();
  metrics.rejected_measurements = measurements.total();
  metrics.missed_ticks = ticks.total();
}

}  // namespace

double ShieldMetrics::changedShare() const {
  return steps == 0 ? 0.0 : static_cast<double>(interventions) / steps;
}

VehicleMetrics vehicleMetricsOf(const Flight& flight, const FlightVehicle& vehicle) {
  VehicleMetrics metrics;
  metrics.name = vehicle.name;
  metrics.path_length_m = pathLength(vehicle, 0, vehicle.samples.size());
  metrics.max_speed_mps = maxSpeed(flight, vehicle);
  metrics.max_acceleration_mps2 = maxAcceleration(flight, vehicle);
  metrics.untracked_time_s = untrackedTime(flight, vehicle);
  addCommands(flight, vehicle, metrics);
  addStatuses(vehicle, metrics);
  return metrics;
}

}  // namespace roundabout::logs
