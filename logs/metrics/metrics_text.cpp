#include "logs/metrics/metrics_text.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace roundabout::logs {

namespace {

/// "-" for what does not exist.
std::string number(double value, int decimals, double scale = 1.0) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value * scale, decimals) : "-";
}

std::string formationTable(const Metrics& metrics) {
  std::string text =
      fmt::format("\n{:<12} {:>7} {:>9} {:>11} {:>11} {:>9} {:>8} {:>7}\n", "formation", "formed",
                  "after s", "extra s", "longest m", "gap m", "touches", "closer");
  for (const FormationMetrics& formation : metrics.formations) {
    double extra_s = -std::numeric_limits<double>::infinity();
    double longest_m = -std::numeric_limits<double>::infinity();
    for (const LegMetrics& leg : formation.legs) {
      extra_s = std::isfinite(leg.extra_time_s) ? std::max(extra_s, leg.extra_time_s) : extra_s;
      longest_m = std::max(longest_m, leg.path_length_m);
    }
    text +=
        fmt::format("{:<12} {:>7} {:>9} {:>11} {:>11} {:>9} {:>8} {:>7}\n", formation.name,
                    formation.formed ? "yes" : "NO", number(formation.time_to_form_s, 1),
                    number(extra_s, 1), number(longest_m, 1), number(formation.body_gap.gap_m, 3),
                    formation.touches, formation.approaches);
  }
  return text;
}

std::string vehicleTable(const Metrics& metrics) {
  std::string text =
      fmt::format("\n{:<12} {:>7} {:>8} {:>9} {:>8} {:>9} {:>9} {:>9} {:>8}\n", "vehicle", "path m",
                  "max m/s", "max m/s2", "cmd Hz", "query us", "p99 us", "rejected", "holding");
  for (const VehicleMetrics& vehicle : metrics.vehicles) {
    double holding_s = 0.0;
    for (const auto& [mode, time_s] : vehicle.time_in_mode_s) {
      holding_s += mode == PlannerMode::kHolding ? time_s : 0.0;
    }
    text += fmt::format("{:<12} {:>7.1f} {:>8.2f} {:>9.2f} {:>8.2f} {:>9} {:>9} {:>9} {:>7.1f}s\n",
                        vehicle.name, vehicle.path_length_m, vehicle.max_speed_mps,
                        vehicle.max_acceleration_mps2, vehicle.command_rate_hz,
                        number(vehicle.compute_time_s.p50, 0, 1e6),
                        number(vehicle.compute_time_s.p99, 0, 1e6),
                        vehicle.rejected_messages + vehicle.rejected_measurements, holding_s);
  }
  return text;
}

/// Of the vehicles whose shield did something; empty if none did.
std::string shieldTable(const Metrics& metrics) {
  std::string rows;
  int steps = 0;
  for (const VehicleMetrics& vehicle : metrics.vehicles) {
    const ShieldMetrics& shield = vehicle.shield;
    steps += shield.steps;
    if (shield.interventions == 0) {
      continue;
    }
    std::vector<std::string> layers;
    for (const auto& [layer, count] : shield.by_layer) {
      layers.push_back(fmt::format("{} {}", count, nameOf(layer)));
    }
    rows += fmt::format("{:<12} {:>7} {:>8} {:>7.1f}% {:>9}  {}\n", vehicle.name, shield.steps,
                        shield.interventions, 100.0 * shield.changedShare(),
                        number(shield.smallest_predicted_gap_m, 3), fmt::join(layers, ", "));
  }
  if (rows.empty()) {
    return steps == 0 ? "\nflown without a shield\n"
                      : fmt::format("\nthe shield changed none of {} steps\n", steps);
  }
  return fmt::format("\n{:<12} {:>7} {:>8} {:>8} {:>9}  {}\n", "shield", "steps", "changed",
                     "share", "least m", "by layer") +
         rows;
}

std::string timingText(const Metrics& metrics) {
  const TimingMetrics& timing = metrics.timing;
  std::string text = fmt::format(
      "\n{} frames in {:.1f} s of data ({:.1f} s of wall clock, {:.2f} x real time); {} missing\n",
      timing.frames, timing.data_duration_s, timing.log_duration_s, timing.real_time_factor,
      timing.missing_frames);
  if (timing.real_time) {
    text += fmt::format(
        "{:.2f} Hz ({}steady); |interval - {:.1f} ms| p50 {} ms, p99 {} ms, max {} ms\n",
        timing.rate_hz, timing.steady ? "" : "NOT ", timing.nominal_interval_s * 1e3,
        number(timing.interval_error_s.p50, 3, 1e3), number(timing.interval_error_s.p99, 3, 1e3),
        number(timing.interval_error_s.max, 3, 1e3));
    for (const VehicleMetrics& vehicle : metrics.vehicles) {
      text += fmt::format("{}: command {} ms after its state (p99 {} ms)\n", vehicle.name,
                          number(vehicle.command_latency_s.p50, 2, 1e3),
                          number(vehicle.command_latency_s.p99, 2, 1e3));
    }
  }
  return text;
}

std::string faultText(const Flight& flight, const Metrics& metrics) {
  std::string text;
  for (const Silence& silence : metrics.faults.silences) {
    text += describe(silence) + "\n";
  }
  for (const SafetyOrderSeen& order : metrics.faults.safety_orders) {
    text += fmt::format("order at {:.1f} s: {} {}\n", order.at_s, order.order,
                        order.vehicle.empty() ? "all" : order.vehicle);
  }
  for (const std::string& refusal : metrics.faults.refusals) {
    text += "refused: " + refusal + "\n";
  }
  for (const Rejected& rejected : flight.rejected) {
    text += fmt::format("{}: {} messages of no use ({})\n", rejected.channel, rejected.count,
                        rejected.reason);
  }
  if (!flight.damage.empty()) {
    text += fmt::format("log damaged in {} places, {} bytes skipped\n", flight.damage.places.size(),
                        flight.damage.skippedBytes());
  }
  return text.empty() ? text : "\n" + text;
}

}  // namespace

std::string headline(const Metrics& metrics) {
  const std::size_t flown = metrics.formations.size();
  const std::size_t touches = metrics.separation.touches.size() + metrics.obstacles.touches.size() +
                              metrics.people.touches.size();
  const std::string formed =
      flown == 0 ? "no formation flown"
                 : fmt::format("{} of {} formations formed", metrics.formationsFormed(), flown);
  if (touches > 0) {
    return formed + fmt::format(", {} collision{}", touches, touches == 1 ? "" : "s");
  }
  const bool seen = metrics.separation.unseen.empty() && metrics.obstacles.unseen.empty();
  return formed + (seen ? ", no bodies touched" : ", nobody saw whether bodies touched");
}

std::string describe(const ClosestGap& gap) {
  return std::isfinite(gap.gap_m) ? fmt::format("{:.3f} m, {} and {} at {:.1f} s", gap.gap_m,
                                                gap.vehicle_a, gap.vehicle_b, gap.at_s)
                                  : "never two of which one was off the floor";
}

std::string describe(const Silence& silence) {
  return fmt::format(
      "{} silent from {:.1f} s {}", silence.who, silence.begin_at_s,
      silence.returned ? fmt::format("to {:.1f} s", silence.end_at_s) : std::string("to the end"));
}

std::string toText(const Flight& flight, const Metrics& metrics) {
  std::string text =
      fmt::format("{}: {}\n", metrics.success ? "SUCCESS" : "FAILED", headline(metrics));
  for (const std::string& failure : metrics.failures) {
    text += "  " + failure + "\n";
  }
  const SeparationMetrics& separation = metrics.separation;
  text += fmt::format("closest bodies       {}\n", describe(separation.body_gap));
  text += fmt::format("closest assumed      {}\n", describe(separation.assumed_gap));
  if (std::isfinite(metrics.obstacles.closest.gap_m)) {
    text += fmt::format("closest obstacle     {}\n", describe(metrics.obstacles.closest));
  }
  if (metrics.people.people > 0) {
    text += fmt::format("closest person       {} of {}\n", describe(metrics.people.closest),
                        metrics.people.people);
  }
  text += fmt::format("closer than assumed  {} times, {:.1f} s in total\n",
                      separation.approaches.size(), separation.approaching_time_s);
  text += fmt::format("{}\n", flight.experiment_note);
  return text + formationTable(metrics) + vehicleTable(metrics) + shieldTable(metrics) +
         timingText(metrics) + faultText(flight, metrics);
}

}  // namespace roundabout::logs
