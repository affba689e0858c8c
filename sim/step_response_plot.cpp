#include "sim/step_response_plot.h"

#include <numbers>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "common/plot/gnuplot_script.h"
#include "sim/step_response.h"

namespace roundabout::sim {

namespace {

constexpr double kDurationS = 4.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;

struct Step {
  StepKind kind;
  double size;
  const char* name;
};

constexpr Step kSteps[] = {{StepKind::kVelocity, 1.0, "velocity, 1 m/s"},
                           {StepKind::kPosition, 2.0, "position, 2 m"},
                           {StepKind::kHeading, std::numbers::pi / 2.0, "heading, 90°"}};

std::string rowOf(const Step& step, const StepFigures& figures) {
  return fmt::format(
      "| {} | {:.3f} s | {:.3f} s | {:.3f} s | {:.2f} s | {:.1f} % | {:.1f}° | {:.2f} m/s² | "
      "{:.1f} "
      "m/s³ |\n",
      step.name, figures.delay_s, figures.lag_s, figures.rise_s, figures.settled_s,
      100.0 * figures.overshoot, kDegrees * figures.max_tilt_rad, figures.max_acceleration_mps2,
      figures.max_jerk_mps3);
}

// Columns: time, response, tilt in degrees, acceleration.
std::vector<std::string> rowsOf(const std::vector<StepSample>& response, double scale) {
  std::vector<std::string> rows;
  for (const StepSample& sample : response) {
    rows.push_back(fmt::format("{:.4f} {:.5f} {:.4f} {:.4f}", sample.time_s,
                               scale * sample.response, kDegrees * sample.tilt_rad,
                               sample.acceleration_mps2));
  }
  return rows;
}

constexpr const char* kPanels = R"(
set multiplot layout 2,2
set grid lt 1 lc rgb '#e8e8e8'
set key bottom right
set xlabel 'time since the command arrived (s)'
set xrange [0:3]
set title 'Velocity step, 0 to 1 m/s'
set ylabel 'm/s'
set yrange [-0.05:1.2]
plot 1 lc rgb '#888888' dt 2 t 'commanded', $velocity every 4 u 1:2 w l lw 2 lc rgb '#1f77b4' t 'flown'
set title 'The same: acceleration and tilt'
set ylabel 'm/s^2'
set y2label 'degrees'
set y2tics
set ytics nomirror
set yrange [-1:4]
set y2range [-5:20]
set key top right
plot $velocity every 4 u 1:4 w l lw 2 lc rgb '#d62728' t 'acceleration', \
     $velocity every 4 u 1:3 axes x1y2 w l lw 2 lc rgb '#2ca02c' t 'tilt (right axis)'
unset y2label
unset y2tics
set ytics mirror
set key bottom right
set xrange [0:4]
set title 'Position step, 0 to 2 m'
set ylabel 'm'
set yrange [-0.1:2.4]
plot 2 lc rgb '#888888' dt 2 t 'commanded', $position every 4 u 1:2 w l lw 2 lc rgb '#1f77b4' t 'flown'
set title 'Heading step, 0 to 90 degrees'
set ylabel 'degrees'
set yrange [-5:110]
plot 90 lc rgb '#888888' dt 2 t 'commanded', $heading every 4 u 1:2 w l lw 2 lc rgb '#1f77b4' t 'flown'
unset multiplot
)";

// Both pictures, of the same blocks.
void draw(plot::GnuplotScript& script, const std::string& path) {
  script.line("set term svg size 960,640 font 'sans,12' background 'white'");
  script.line("set output {}", plot::gnuplotString(path + ".svg"));
  script.line("{}", kPanels);
  script.line("set output");
  script.line("reset");
  script.line("set term pngcairo size 960,640 font 'sans,11'");
  script.line("set output {}", plot::gnuplotString(path + ".png"));
  script.line("{}", kPanels);
  script.run();
}

}  // namespace

std::string drawStepResponses(const config::Sim& sim, const std::string& path) {
  std::string table =
      "| step | delay (5 %) | lag (63 %) | rise (10–90 %) | settled (5 %) | overshoot | most tilt "
      "| "
      "most acceleration | most jerk |\n|---|---|---|---|---|---|---|---|---|\n";
  plot::GnuplotScript script;
  for (const Step& step : kSteps) {
    const std::vector<StepSample> response = stepResponse(sim, step.kind, step.size, kDurationS);
    table += rowOf(step, figuresOf(response, step.size));
    const bool heading = step.kind == StepKind::kHeading;
    script.data(heading                            ? "heading"
                : step.kind == StepKind::kVelocity ? "velocity"
                                                   : "position",
                rowsOf(response, heading ? kDegrees : 1.0));
  }
  table += "\n| from | stops within |\n|---|---|\n";
  for (const double speed_mps : {0.5, 1.0, 2.0}) {
    table +=
        fmt::format("| {:.1f} m/s | {:.2f} m |\n", speed_mps, stoppingDistanceM(sim, speed_mps));
  }
  draw(script, path);
  return table;
}

}  // namespace roundabout::sim
