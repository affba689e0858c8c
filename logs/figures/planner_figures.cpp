// What planners did over time, and how fast messages came.

#include <algorithm>
#include <array>

#include "common/plot/palette.h"
#include "logs/figures/time_axis.h"
#include "logs/figures/time_figures.h"

namespace roundabout::logs {

namespace {

using namespace plot;  // NOLINT(google-build-using-namespace): the drawing of this file

constexpr double kRateWindowS = 1.0;

/// Colours as in the report's player (report/player_page.h).
constexpr std::array<Color, 9> kModeColors = {{{0xc9, 0xce, 0xd6},
                                               {0xdf, 0xe3, 0xe9},
                                               {0x8f, 0xc7, 0xe8},
                                               {0x3b, 0x7d, 0xd8},
                                               {0x58, 0xb8, 0x7a},
                                               {0xf0, 0xa0, 0x20},
                                               {0xa9, 0x8f, 0xd8},
                                               {0xdf, 0xe3, 0xe9},
                                               {0xb3, 0x26, 0x1e}}};

/// One mode without a break.
struct Stretch {
  double begin_s;
  double end_s;
  std::size_t mode;
};

std::vector<Stretch> stretchesOf(const Flight& flight, const FlightVehicle& vehicle) {
  std::vector<Stretch> stretches;
  const PlannerStatus* before = nullptr;
  for (const Logged<PlannerStatus>& entry : vehicle.statuses) {
    const PlannerStatus& status = entry.value;
    const auto mode = static_cast<std::size_t>(status.mode);
    if (status.utime == 0 || mode >= kModeColors.size()) {
      continue;
    }
    const double now_s = flight.secondsAt(status.utime);
    const bool silent =
        before == nullptr || core::toSeconds(status.utime - before->utime) > kSilenceS;
    if (!silent) {
      stretches.back().end_s = now_s;
    }
    if (silent || mode != stretches.back().mode) {
      stretches.push_back({now_s, now_s, mode});
    }
    before = &status;
  }
  return stretches;
}

std::string vehicleCurve(const std::string& data, const Flight& flight, std::size_t index,
                         const std::string& more) {
  return fmt::format("${}{} with lines {} lc rgb \"{}\" title {}", data, index, more,
                     hex(vehicleColor(index, flight.vehicles.size())),
                     gnuplotString(flight.vehicles[index].name));
}

/// How many of the times (s, in order) lie in each window; a row each.
std::vector<std::string> rateRows(const std::vector<double>& times_s, double end_s) {
  std::vector<std::string> rows;
  auto at = times_s.begin();
  for (double begin_s = 0.0; begin_s + kRateWindowS <= end_s; begin_s += kRateWindowS) {
    const auto to = std::lower_bound(at, times_s.end(), begin_s + kRateWindowS);
    rows.push_back(fmt::format("{:.2f} {:.3f}", begin_s + 0.5 * kRateWindowS,
                               static_cast<double>(to - at) / kRateWindowS));
    at = to;
  }
  return rows;
}

}  // namespace

void drawModes(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
               Figure& figure) {
  figure.title = "Modes";
  figure.caption = "of the planners; a gap: it was silent";
  beginTimeFigure(script, flight, metrics, figure);
  std::vector<std::string> rows;
  std::array<bool, kModeColors.size()> seen{};
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    for (const Stretch& stretch : stretchesOf(flight, flight.vehicles[i])) {
      rows.push_back(fmt::format("{:.3f} {} {:.3f} {}", stretch.begin_s, i,
                                 stretch.end_s - stretch.begin_s,
                                 rgbNumber(kModeColors[stretch.mode])));
      seen[stretch.mode] = true;
    }
    script.line("set ytics {} ({} {})", i == 0 ? "" : "add", gnuplotString(flight.vehicles[i].name),
                i);
  }
  const std::size_t count = flight.vehicles.size();
  const double width =
      std::clamp(200.0 / static_cast<double>(std::max<std::size_t>(count, 1)), 2.0, 26.0);
  script.data("modes", rows);
  script.line("set yrange [{}:-0.7]", static_cast<double>(count) - 0.3);
  script.line("set grid noytics");
  // Without statuses there is nothing to plot, but axes.
  std::string curves = rows.empty() ? "NaN notitle"
                                    : fmt::format(
                                          "$modes using 1:2:3:(0):4 with vectors nohead lw {:.1f} "
                                          "lc rgb variable notitle",
                                          width);
  for (std::size_t mode = 0; mode < seen.size(); ++mode) {
    if (seen[mode]) {
      curves +=
          fmt::format(", keyentry with lines lw 8 lc rgb \"{}\" title {}", hex(kModeColors[mode]),
                      gnuplotString(nameOf(static_cast<PlannerMode>(mode))));
    }
  }
  endFigure(script, kTimeFigureSize, figure.files(), "plot " + curves);
}

void drawRates(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
               Figure& figure) {
  figure.title = "Rates";
  figure.caption =
      "messages a second of data time: frames (left), commands of each planner (right)";
  beginTimeFigure(script, flight, metrics, figure);
  const double end_s = flight.secondsAt(flight.frames.back().utime);
  std::vector<double> times_s;
  for (const Frame& frame : flight.frames) {
    times_s.push_back(flight.secondsAt(frame.utime));
  }
  script.data("frames", rateRows(times_s, end_s));
  std::string curves = "$frames with lines lw 2 lc rgb \"#1f4e79\" title \"frames\"";
  double highest_hz = 1.0;
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    times_s.clear();
    for (const Logged<core::Command>& command : flight.vehicles[i].commands) {
      times_s.push_back(flight.secondsAt(command.value.utime));
    }
    std::sort(times_s.begin(), times_s.end());
    script.data(fmt::format("rate{}", i), rateRows(times_s, end_s));
    curves += ", \\\n     " + vehicleCurve("rate", flight, i, "axes x1y2 lw 1.2");
    highest_hz = std::max(highest_hz, metrics.vehicles[i].command_rate_hz);
  }
  const double nominal_s = metrics.timing.nominal_interval_s;
  script.line("set ylabel \"frames (Hz)\"");
  script.line("set yrange [0:{:.1f}]", nominal_s > 0.0 ? 1.25 / nominal_s : 250.0);
  script.line("set ytics nomirror");
  script.line("set y2label \"commands (Hz)\"");
  script.line("set y2range [0:{:.1f}]", 2.0 * highest_hz);
  script.line("set y2tics");
  script.line("set key at graph 1.09, 1 left top Left reverse samplen 1.5 spacing 1.2");
  script.line("set rmargin 26");
  endFigure(script, kTimeFigureSize, figure.files(), "plot " + curves);
}

void drawLatency(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                 Figure& figure) {
  figure.title = "Latency of commands";
  figure.caption = "from a frame to the command that answers it, by the logger's clock";
  beginTimeFigure(script, flight, metrics, figure);
  script.line("set ylabel \"latency (ms)\"");
  script.line("set yrange [0:*]");
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    std::vector<std::string> rows;
    for (const Logged<core::Command>& command : flight.vehicles[i].commands) {
      const std::size_t index = flight.frameAt(command.value.state_utime);
      if (index < flight.frames.size() && flight.frames[index].utime == command.value.state_utime) {
        const core::Utime latency = command.log_utime - flight.frames[index].log_utime;
        rows.push_back(fmt::format("{:.3f} {:.4f}", flight.secondsAt(command.value.state_utime),
                                   1e3 * core::toSeconds(latency)));
      }
    }
    script.data(fmt::format("latency{}", i), rows);
    if (!rows.empty()) {
      parts.push_back(vehicleCurve("latency", flight, i, "lw 1.2"));
    }
  }
  endFigure(
      script, kTimeFigureSize, figure.files(),
      parts.empty() ? "plot NaN notitle" : fmt::format("plot {}", fmt::join(parts, ", \\\n     ")));
}

}  // namespace roundabout::logs
