#include "logs/report/report.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "common/config/experiment_file.h"
#include "logs/files.h"
#include "logs/metrics/metrics_text.h"
#include "logs/report/html.h"
#include "logs/report/player.h"
#include "logs/report/style.h"

namespace roundabout::logs {

namespace {

std::string number(double value, int decimals, double scale = 1.0) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value * scale, decimals) : "–";
}

/// A count that should be zero.
std::string zeroIsGood(std::int64_t count, const char* otherwise) {
  return count == 0 ? "0" : fmt::format("<span class=\"{}\">{}</span>", otherwise, count);
}

std::string title(const Flight& flight) {
  return escaped(flight.experiment && !flight.experiment->name.empty() ? flight.experiment->name
                                                                       : flight.log_file);
}

std::string verdict(const Metrics& metrics) {
  std::string html =
      fmt::format("<div class=\"verdict{}\"><b>{}</b> {}", metrics.success ? "" : " failed",
                  metrics.success ? "Success." : "Failed.", escaped(headline(metrics)));
  if (!metrics.failures.empty()) {
    html += "<ul>";
    for (const std::string& failure : metrics.failures) {
      html += "<li>" + escaped(failure) + "</li>";
    }
    html += "</ul>";
  }
  return html + "</div>\n";
}

std::string card(const std::string& value, const std::string& text, const char* look = "") {
  return fmt::format("<div class=\"card\"><b class=\"{}\">{}</b><span>{}</span></div>\n", look,
                     value, text);
}

std::string gapCard(const ClosestGap& gap, const std::string& what, const char* below_zero) {
  if (!std::isfinite(gap.gap_m)) {
    return card("–", what + ": never two of which one was off the floor");
  }
  return card(fmt::format("{:.2f} m", gap.gap_m),
              fmt::format("{}, {} and {} at {:.1f} s", what, escaped(gap.vehicle_a),
                          escaped(gap.vehicle_b), gap.at_s),
              gap.gap_m < 0.0 ? below_zero : "good");
}

std::string cards(const Metrics& metrics) {
  const SeparationMetrics& separation = metrics.separation;
  return "<div class=\"cards\">\n" + gapCard(separation.body_gap, "closest bodies", "bad") +
         gapCard(separation.assumed_gap, "closest assumed radii", "warn") +
         card(fmt::format("{}", separation.approaches.size()),
              fmt::format("closer approaches than the assumed radii, {:.1f} s in total",
                          separation.approaching_time_s)) +
         card(fmt::format("{:.0f} s", metrics.timing.data_duration_s),
              fmt::format("flown in {:.1f} s of wall clock, {:.1f} × real time",
                          metrics.timing.log_duration_s, metrics.timing.real_time_factor)) +
         "</div>\n";
}

std::string formationTable(const Metrics& metrics) {
  std::vector<std::vector<std::string>> rows;
  for (const FormationMetrics& formation : metrics.formations) {
    std::vector<double> extra_s;
    double path_m = 0.0;
    double straight_m = 0.0;
    for (const LegMetrics& leg : formation.legs) {
      if (leg.reached) {
        extra_s.push_back(leg.extra_time_s);
      }
      path_m += leg.path_length_m;
      straight_m += leg.straight_line_m;
    }
    const Spread extra = spreadOf(std::move(extra_s));
    rows.push_back(
        {escaped(formation.name),
         formation.formed ? "<span class=\"good\">yes</span>" : "<span class=\"bad\">no</span>",
         number(formation.begin_at_s, 1), number(formation.time_to_form_s, 1), number(extra.p50, 1),
         number(extra.max, 1), number(straight_m, 1), number(path_m, 1),
         number(formation.body_gap.gap_m, 2), zeroIsGood(formation.touches, "bad"),
         zeroIsGood(formation.approaches, "warn")});
  }
  return htmlTable({"formation", "formed", "from (s)", "formed after (s)", "extra time, median (s)",
                    "extra time, worst (s)", "straight lines (m)", "paths (m)",
                    "closest bodies (m)", "touches", "closer than assumed"},
                   rows) +
         fmt::format(
             "<p class=\"quiet\">Extra time: until within {} m of the goal, beyond a "
             "straight line at preferred speed. Lines and paths are sums over the "
             "vehicles.</p>\n",
             kGoalDistanceM);
}

std::string vehicleTable(const Metrics& metrics) {
  std::vector<std::vector<std::string>> rows;
  for (const VehicleMetrics& vehicle : metrics.vehicles) {
    double holding_s = 0.0;
    for (const auto& [mode, time_s] : vehicle.time_in_mode_s) {
      holding_s += mode == PlannerMode::kHolding ? time_s : 0.0;
    }
    rows.push_back({escaped(vehicle.name), escaped(vehicle.policy),
                    number(vehicle.path_length_m, 1), number(vehicle.max_speed_mps, 2),
                    number(vehicle.max_acceleration_mps2, 2), number(vehicle.command_rate_hz, 2),
                    number(vehicle.compute_time_s.p50, 0, 1e6),
                    number(vehicle.compute_time_s.p99, 0, 1e6), number(holding_s, 1),
                    number(vehicle.untracked_time_s, 2), zeroIsGood(vehicle.missed_ticks, "warn"),
                    zeroIsGood(vehicle.rejected_messages + vehicle.rejected_measurements, "warn")});
  }
  return htmlTable({"vehicle", "policy", "path (m)", "top speed (m/s)", "top acceleration (m/s²)",
                    "commands (Hz)", "query p50 (µs)", "query p99 (µs)", "safety hold (s)",
                    "untracked (s)", "missed ticks", "rejected"},
                   rows);
}

std::string shieldTable(const Metrics& metrics) {
  std::vector<std::vector<std::string>> rows;
  for (const VehicleMetrics& vehicle : metrics.vehicles) {
    const ShieldMetrics& shield = vehicle.shield;
    if (shield.steps == 0) {
      continue;
    }
    std::vector<std::string> layers;
    for (const auto& [layer, count] : shield.by_layer) {
      layers.push_back(fmt::format("{} {}", count, nameOf(layer)));
    }
    rows.push_back(
        {escaped(vehicle.name), fmt::format("{}", shield.steps),
         fmt::format("{}", shield.interventions), number(shield.changedShare(), 1, 100.0),
         fmt::format("{}", fmt::join(layers, ", ")), number(shield.smallest_predicted_gap_m, 3)});
  }
  if (rows.empty()) {
    return "<p class=\"quiet\">Flown without a shield.</p>\n";
  }
  return htmlTable(
      {"shield", "steps", "changed", "share (%)", "by layer", "smallest gap of brake paths (m)"},
      rows);
}

std::string timingSection(const Metrics& metrics) {
  const TimingMetrics& timing = metrics.timing;
  std::string html = fmt::format(
      "<p>{} frames, {} missing, {} out of order; nominal interval {:.3f} ms of data time.</p>\n",
      timing.frames, zeroIsGood(timing.missing_frames, "bad"),
      zeroIsGood(timing.frames_out_of_order, "warn"), timing.nominal_interval_s * 1e3);
  if (!timing.real_time) {
    return html +
           "<p class=\"quiet\">Flown in lockstep: rates and latencies on the wall clock say "
           "nothing "
           "about the lab, so none are given.</p>\n";
  }
  html += fmt::format(
      "<p>VEHICLE_STATES at <b>{:.2f} Hz</b>, {}; |interval − {:.1f} ms|: p50 {} ms, p99 <b>{} "
      "ms</b>, largest {} ms. Steady means: nothing missing, rate within {} % and p99 within {} % "
      "of "
      "the interval.</p>\n",
      timing.rate_hz,
      timing.steady ? "<span class=\"good\">steady</span>"
                    : "<span class=\"bad\">not steady</span>",
      timing.nominal_interval_s * 1e3, number(timing.interval_error_s.p50, 3, 1e3),
      number(timing.interval_error_s.p99, 3, 1e3), number(timing.interval_error_s.max, 3, 1e3),
      kRateTolerance * 100.0, kIntervalErrorTolerance * 100.0);
  std::vector<std::vector<std::string>> rows;
  for (const VehicleMetrics& vehicle : metrics.vehicles) {
    const Spread& latency = vehicle.command_latency_s;
    rows.push_back({escaped(vehicle.name), number(latency.p50, 2, 1e3), number(latency.p99, 2, 1e3),
                    number(latency.max, 2, 1e3)});
  }
  return html + htmlTable({"state to command", "p50 (ms)", "p99 (ms)", "largest (ms)"}, rows);
}

std::string faultSection(const Flight& flight, const Metrics& metrics) {
  std::vector<std::string> faults;
  for (const Silence& silence : metrics.faults.silences) {
    faults.push_back(describe(silence));
  }
  for (const SafetyOrderSeen& order : metrics.faults.safety_orders) {
    faults.push_back(fmt::format("operator's order at {:.1f} s: {} {}", order.at_s, order.order,
                                 order.vehicle.empty() ? "all" : order.vehicle));
  }
  for (const std::string& refusal : metrics.faults.refusals) {
    faults.push_back("refused by fleet: " + refusal);
  }
  for (const Rejected& rejected : flight.rejected) {
    faults.push_back(fmt::format("{}: {} messages of no use ({})", rejected.channel, rejected.count,
                                 rejected.reason));
  }
  for (const Damage& damage : flight.damage.places) {
    faults.push_back(fmt::format("log damaged at byte {}: {} bytes skipped, {}", damage.offset,
                                 damage.bytes, damage.reason));
  }
  if (faults.empty()) {
    return "<p class=\"good\">None.</p>\n";
  }
  std::string html = "<ul>";
  for (const std::string& fault : faults) {
    html += "<li>" + escaped(fault) + "</li>\n";
  }
  return html + "</ul>\n";
}

std::string picture(const std::string& file, const char* type, const std::string& title) {
  return fmt::format("<img alt=\"{}\" src=\"data:image/{};base64,{}\">\n", escaped(title), type,
                     base64(readFile(file)));
}

// Bitmaps here: hundreds of circles are smaller as one.
std::string plans(const Figures& figures) {
  std::string html = "<div class=\"plans\">\n";
  for (const Figure& figure : figures.formations) {
    html += picture(figure.png_file, "png", figure.title);
  }
  if (!figures.overview.png_file.empty()) {
    html += picture(figures.overview.png_file, "png", figures.overview.title);
  }
  return html + "</div>\n";
}

std::string curves(const Figures& figures) {
  std::string html;
  for (const Figure& figure : figures.over_time) {
    html += "<figure>" + picture(figure.svg_file, "svg+xml", figure.title) + "<figcaption>" +
            escaped(figure.caption) + "</figcaption></figure>\n";
  }
  return html;
}

std::string experimentSection(const Flight& flight, const std::string& command_line) {
  std::string html = "<p class=\"quiet\">" + escaped(flight.experiment_note) + "</p>\n";
  if (!command_line.empty()) {
    html += "<pre>" + escaped(command_line) + "</pre>\n";
  }
  if (flight.experiment) {
    html +=
        fmt::format("<p>Seed {}, policy {}, {} vehicles.</p>\n", flight.experiment->seed,
                    escaped(flight.experiment->planner.policy), flight.experiment->vehicles.size());
    html += "<details><summary>the whole experiment file, defaults included</summary><pre>" +
            escaped(config::toYaml(*flight.experiment)) + "</pre></details>\n";
  }
  return html;
}

}  // namespace

void writeReport(const std::string& file, const Flight& flight, const Metrics& metrics,
                 const Figures& figures, const std::string& command_line) {
  const std::string name = title(flight);
  const std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + name +
      "</title><style>" + kReportStyle + "</style></head><body>\n<h1>" + name + "</h1>\n" +
      "<p class=\"quiet\">" + escaped(flight.log_file) + "</p>\n" + verdict(metrics) +
      cards(metrics) + playerHtml(flight, metrics) + "<h2>Formations</h2>\n" + plans(figures) +
      formationTable(metrics) + "<h2>Over time</h2>\n" + curves(figures) + "<h2>Vehicles</h2>\n" +
      vehicleTable(metrics) + shieldTable(metrics) + "<h2>Timing</h2>\n" + timingSection(metrics) +
      "<h2>Faults</h2>\n" + faultSection(flight, metrics) + "<h2>Experiment</h2>\n" +
      experimentSection(flight, command_line) + "</body></html>\n";
  writeFile(file, html);
}

}  // namespace roundabout::logs
