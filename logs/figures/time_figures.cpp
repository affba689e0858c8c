#include "logs/figures/time_figures.h"

#include <algorithm>
#include <cmath>

#include "common/plot/palette.h"
#include "logs/figures/time_axis.h"
#include "logs/metrics/separation.h"

namespace roundabout::logs {

namespace {

using namespace plot;  // NOLINT(google-build-using-namespace): the drawing of this file

// Points along the time axis: more than this cannot be seen.
constexpr std::size_t kMostBins = 800;
constexpr double kHighestGapM = 3.0;

/// [begin, end) frames that share a point of a curve.
struct Bin {
  std::size_t begin;
  std::size_t end;
};

std::vector<Bin> binsOf(const Flight& flight) {
  const std::size_t count = flight.frames.size();
  const std::size_t width = (count + kMostBins - 1) / kMostBins;
  std::vector<Bin> bins;
  for (std::size_t begin = 0; begin < count; begin += width) {
    bins.push_back({begin, std::min(begin + width, count)});
  }
  return bins;
}

double timeOf(const Flight& flight, const Bin& bin) {
  return flight.secondsAt(flight.frames[bin.begin].utime);
}

/// m. How much nearer than touching assumed radii bodies may come: of the pair with most.
double assumedMargin(const Flight& flight) {
  std::vector<double> margins_m;
  for (const FlightVehicle& vehicle : flight.vehicles) {
    margins_m.push_back(vehicle.assumed_radius_m - vehicle.body_radius_m);
  }
  std::sort(margins_m.rbegin(), margins_m.rend());
  return margins_m.size() < 2 ? 0.0 : margins_m[0] + margins_m[1];
}

}  // namespace

void drawSeparation(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                    Figure& figure) {
  figure.title = "Gap between the two closest bodies";
  figure.caption = "horizontal, in the air; shaded: on the way to a formation";
  beginTimeFigure(script, flight, metrics, figure);
  const GapsOverTime gaps = gapsOverTime(flight);
  std::vector<std::string> rows;
  for (const Bin& bin : binsOf(flight)) {
    const double gap_m = closestIn(flight, gaps, bin.begin, bin.end).gap_m;
    rows.push_back(std::isfinite(gap_m) ? fmt::format("{:.3f} {:.4f}", timeOf(flight, bin), gap_m)
                                        : "");
  }
  const double closest_m = metrics.separation.body_gap.gap_m;
  const double lowest_m = std::min(-0.1, std::isfinite(closest_m) ? 1.15 * closest_m : 0.0);
  const double margin_m = assumedMargin(flight);
  script.data("gap", rows);
  script.line("set ylabel \"gap (m)\"");
  script.line("set yrange [{:.3f}:{}]", lowest_m, kHighestGapM);
  endFigure(script, kTimeFigureSize, figure.files(),
            fmt::format("plot $gap with lines lw 1.8 lc rgb \"#1f4e79\" title \"closest bodies\", "
                        "{:.3f} with lines lw 1.5 dt 2 lc rgb \"#e08a00\" title \"assumed radii\", "
                        "0 with lines lw 1.5 lc rgb \"#c62828\" title \"bodies touch\"",
                        margin_m));
}

void drawSpeed(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
               Figure& figure) {
  figure.title = "Speed";
  figure.caption = "published velocity, all three axes";
  beginTimeFigure(script, flight, metrics, figure);
  script.line("set ylabel \"speed (m/s)\"");
  script.line("set yrange [0:*]");
  std::vector<std::string> parts;
  const std::vector<Bin> bins = binsOf(flight);
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    const FlightVehicle& vehicle = flight.vehicles[i];
    std::vector<std::string> rows;
    for (const Bin& bin : bins) {
      const Sample& sample = vehicle.samples[bin.begin];
      rows.push_back(sample.tracked ? fmt::format("{:.3f} {:.3f}", timeOf(flight, bin),
                                                  sample.velocity_world_mps.norm())
                                    : "");
    }
    script.data(fmt::format("speed{}", i), rows);
    parts.push_back(fmt::format("$speed{} with lines lw 1.3 lc rgb \"{}\" title {}", i,
                                hex(vehicleColor(i, flight.vehicles.size())),
                                gnuplotString(vehicle.name)));
  }
  endFigure(script, kTimeFigureSize, figure.files(),
            fmt::format("plot {}", fmt::join(parts, ", \\\n     ")));
}

void drawFrameIntervals(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                        Figure& figure) {
  figure.title = "Frame intervals";
  figure.caption = "shortest and longest interval between logged frames";
  beginTimeFigure(script, flight, metrics, figure);
  std::vector<std::string> rows;
  for (const Bin& bin : binsOf(flight)) {
    double shortest_ms = std::numeric_limits<double>::infinity();
    double longest_ms = 0.0;
    for (std::size_t i = std::max<std::size_t>(bin.begin, 1); i < bin.end; ++i) {
      const double interval_ms =
          core::toSeconds(flight.frames[i].log_utime - flight.frames[i - 1].log_utime) * 1e3;
      shortest_ms = std::min(shortest_ms, interval_ms);
      longest_ms = std::max(longest_ms, interval_ms);
    }
    if (std::isfinite(shortest_ms)) {
      rows.push_back(
          fmt::format("{:.3f} {:.4f} {:.4f}", timeOf(flight, bin), shortest_ms, longest_ms));
    }
  }
  const double nominal_ms = metrics.timing.nominal_interval_s * 1e3;
  script.data("interval", rows);
  script.line("set ylabel \"interval (ms)\"");
  script.line("set yrange [0:{:.3f}]",
              std::max(2.0 * nominal_ms, 1.1e3 * metrics.timing.longest_interval_s));
  endFigure(script, kTimeFigureSize, figure.files(),
            fmt::format("plot $interval using 1:2:3 with filledcurves fc rgb \"#8fb3d9\" fs solid "
                        "noborder title \"min to max\", {:.4f} with lines lw 1.5 dt 2 lc rgb "
                        "\"#333333\" title \"nominal\"",
                        nominal_ms));
}

}  // namespace roundabout::logs
