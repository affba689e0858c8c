#include "learning/evaluation/figures.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/plot/canvas.h"
#include "common/plot/palette.h"
#include "common/plot/plan_view.h"
#include "common/plot/plot_command.h"
#include "learning/evaluation/summary.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;
using plot::Color;
using plot::GnuplotScript;
using plot::gnuplotString;
using plot::PlotCommand;

constexpr double kGroupWidth = 0.8;  // of the distance between groups, for all bars
// Of the comparison, pixels; the key stands on the right.
constexpr int kPageLeft = 95;
constexpr int kPageRight = 340;
constexpr double kLetter_px = 7.5;  // of a group's name
constexpr double kStarRadius_m = 0.2;
constexpr double kCirclesEvery_s = 0.4;
constexpr double kTimesEvery_s = 2.0;
constexpr double kTimesApart_m = 0.5;  // from that of the arrival
constexpr int kFramesPerSecond = 10;
constexpr int kHoldFrames = 10;  // at the end of an animation

/// "ga3c_cadrl_IROS18_4_agents_17"
std::string fileNameOf(const Evaluation& evaluation, std::size_t row) {
  const Place place = placeOf(evaluation, row);
  std::string name = fmt::format("{}_{}_{}", labelOf(evaluation, place.contestant),
                                 evaluation.suite.groups[place.group].name, place.number);
  std::string clean;
  for (const char character : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(character)) != 0;
    if (plain || (!clean.empty() && clean.back() != '_')) {
      clean += plain ? character : '_';
    }
  }
  return clean;
}

std::string titleOf(const Evaluation& evaluation, std::size_t row) {
  const Place place = placeOf(evaluation, row);
  const CaseGroup& group = evaluation.suite.groups[place.group];
  return fmt::format("{}: {}{}", labelOf(evaluation, place.contestant), group.name,
                     group.cases.size() > 1 ? fmt::format(", case {}", place.number) : "");
}

/// Where a contestant's bar stands.
double barAt(const Evaluation& evaluation, const Score& score) {
  const double bars = static_cast<double>(evaluation.contestants.size());
  const double offset = (static_cast<double>(score.contestant) + 0.5) / bars - 0.5;
  return static_cast<double>(score.group) + kGroupWidth * offset;
}

std::string barRow(const Evaluation& evaluation, const Score& score, double height) {
  return fmt::format("{:.4f} {:.4f} {:.4f}", barAt(evaluation, score), height,
                     0.9 * kGroupWidth / static_cast<double>(evaluation.contestants.size()));
}

/// Rows that one contestant adds to a panel.
template <class Row>
std::vector<std::string> rowsOf(const std::vector<Score>& scores, std::size_t contestant, Row row) {
  std::vector<std::string> rows;
  for (const Score& score : scores) {
    if (score.contestant == contestant) {
      rows.push_back(row(score));
    }
  }
  return rows;
}

std::string boxStyle(const Color& color, const std::string& title) {
  return fmt::format("with boxes fc rgb \"{}\" fs solid border lc rgb \"white\" {}",
                     plot::hex(color), title.empty() ? "notitle" : "title " + gnuplotString(title));
}

std::string failurePanel(GnuplotScript& script, const Evaluation& evaluation,
                         const std::vector<Score>& scores) {
  PlotCommand parts(script);
  const std::size_t count = evaluation.contestants.size();
  const auto bars = [&](std::size_t contestant, auto percent) {
    return rowsOf(scores, contestant,
                  [&](const Score& score) { return barRow(evaluation, score, percent(score)); });
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Color color = plot::vehicleColor(i, count);
    // What got stuck lies, paler, on top of what collided.
    parts.add(bars(i, [](const Score& s) { return 100.0 * (s.collision_share + s.stuck_share); }),
              boxStyle(plot::mix(plot::kWhite, color, 0.45), ""));
    parts.add(bars(i, [](const Score& s) { return 100.0 * s.collision_share; }),
              boxStyle(color, labelOf(evaluation, i)));
  }
  return parts.text();
}

/// Of groups of which a contestant solved no case there is nothing to see.
std::string timePanel(GnuplotScript& script, const Evaluation& evaluation,
                      const std::vector<Score>& scores) {
  PlotCommand parts(script);
  const std::size_t count = evaluation.contestants.size();
  std::vector<Score> solved;
  std::copy_if(scores.begin(), scores.end(), std::back_inserter(solved),
               [](const Score& score) { return score.own.cases > 0; });
  if (solved.empty()) {
    return "set yrange [0:1]\nplot -1 notitle";
  }
  const auto bars = [&](std::size_t contestant, double ExtraTimes::*time_s) {
    return rowsOf(solved, contestant,
                  [&](const Score& score) { return barRow(evaluation, score, score.own.*time_s); });
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Color color = plot::vehicleColor(i, count);
    parts.add(bars(i, &ExtraTimes::percentile90_s),
              boxStyle(plot::mix(plot::kWhite, color, 0.3), ""));
    parts.add(bars(i, &ExtraTimes::percentile75_s),
              boxStyle(plot::mix(plot::kWhite, color, 0.6), ""));
    parts.add(bars(i, &ExtraTimes::mean_s),
              fmt::format("with points pt 7 ps 0.7 lc rgb \"{}\" notitle",
                          plot::hex(plot::mix(color, plot::kBlack, 0.4))));
  }
  return parts.text();
}

/// The way to one set of goals: who is where when.
struct Motion {
  std::span<const AgentSpec> agents;
  std::span<const core::Polygon> obstacles;
  std::vector<Vector2d> goals_m;
  Leg trace;
  double step_s;
};

std::vector<Motion> flyAgain(const Evaluation& evaluation, std::size_t row) {
  const Place place = placeOf(evaluation, row);
  const TestCase& test_case = evaluation.suite.groups[place.group].cases[place.number];
  Trace trace;
  CaseRunner(evaluation).run(row, &trace);
  std::vector<Motion> motions;
  for (Leg& leg : trace) {
    std::vector<Vector2d> goals_m;
    for (std::size_t i = 0; i < test_case.agents.size(); ++i) {
      goals_m.push_back(motions.empty() ? test_case.agents[i].goal_m
                                        : test_case.later_goals_m[motions.size() - 1][i]);
    }
    motions.push_back({test_case.agents, test_case.obstacles, std::move(goals_m), std::move(leg),
                       evaluation.rules.planning_step_s});
  }
  return motions;
}

void include(plot::PlanView& view, const Motion& motion) {
  for (std::size_t i = 0; i < motion.agents.size(); ++i) {
    view.include(motion.goals_m[i], std::max(motion.agents[i].radius_m, kStarRadius_m));
    for (const std::vector<TracePoint>& points : motion.trace) {
      view.include(points[i].position_m, motion.agents[i].radius_m);
    }
  }
  for (const core::Polygon& obstacle : motion.obstacles) {
    for (const Vector2d& corner : obstacle) {
      view.include(corner, 0.0);
    }
  }
}

void addObstacles(PlotCommand& parts, const Motion& motion) {
  for (const core::Polygon& obstacle : motion.obstacles) {
    parts.add(plot::outlineRows(obstacle), plot::kObstacleStyle);
  }
}

void addGoals(PlotCommand& parts, const Motion& motion) {
  const std::size_t count = motion.agents.size();
  for (std::size_t i = 0; i < count; ++i) {
    parts.add(plot::starRows(motion.goals_m[i], kStarRadius_m),
              fmt::format("with filledcurves closed fc rgb \"{}\" fs solid border lc rgb \"white\" "
                          "notitle",
                          plot::hex(plot::vehicleColor(i, count))));
  }
}

void addPaths(PlotCommand& parts, const Motion& motion, std::size_t end) {
  const std::size_t count = motion.agents.size();
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::string> rows;
    for (std::size_t step = 0; step < end; ++step) {
      const Vector2d& at = motion.trace[step][i].position_m;
      rows.push_back(fmt::format("{:.3f} {:.3f}", at.x(), at.y()));
    }
    parts.add(rows,
              fmt::format("with lines lw 1.4 lc rgb \"{}\" notitle",
                          plot::hex(plot::mix(plot::vehicleColor(i, count), plot::kBlack, 0.3))));
  }
}

std::string circleRow(const Motion& motion, std::size_t step, std::size_t agent, double lightness) {
  const std::size_t count = motion.agents.size();
  const Vector2d& at = motion.trace[step][agent].position_m;
  const Color color = plot::mix(plot::vehicleColor(agent, count), plot::kWhite, lightness);
  return fmt::format("{:.3f} {:.3f} {:.3f} {}", at.x(), at.y(), motion.agents[agent].radius_m,
                     plot::rgbNumber(color));
}

constexpr const char* kCircles =
    "with circles lc rgb variable fs solid border lc rgb \"#777777\" notitle";

void drawLeg(GnuplotScript& script, const Motion& motion, const std::string& title,
             const std::string& file) {
  plot::PlanView view;
  include(view, motion);
  plot::beginFigure(script, view.size(), title);
  view.set(script, "circles lighten with time, numbers: s, stars: goals, crosses: collisions");
  const auto every = static_cast<std::size_t>(std::lround(kCirclesEvery_s / motion.step_s));
  const auto labelled = static_cast<std::size_t>(std::lround(kTimesEvery_s / motion.step_s));
  const std::size_t agents = motion.agents.size();
  const bool crowded = agents > 10;  // room for the times of arrival only
  std::vector<std::string> circles;
  std::vector<std::string> times;
  std::vector<std::string> crashes;
  for (std::size_t step = 0; step < motion.trace.size(); ++step) {
    const double lightness =
        0.8 * static_cast<double>(step) / static_cast<double>(motion.trace.size());
    for (std::size_t i = 0; i < agents; ++i) {
      const bool done = motion.trace[step][i].done;
      const bool arrives = done && step > 0 && !motion.trace[step - 1][i].done;
      if (arrives || (!done && step % every == 0)) {
        circles.push_back(circleRow(motion, step, i, lightness));
      }
      const bool timed =
          !done && !crowded && step > 0 && step % labelled == 0 &&
          (motion.trace[step][i].position_m - motion.trace.back()[i].position_m).norm() >
              kTimesApart_m;
      if (arrives || timed) {
        const Vector2d& at = motion.trace[step][i].position_m;
        times.push_back(fmt::format("{:.3f} {:.3f} \"{:.1f}\"", at.x(), at.y(),
                                    static_cast<double>(step) * motion.step_s));
        if (motion.trace[step][i].collided) {
          crashes.push_back(fmt::format("{:.3f} {:.3f}", at.x(), at.y()));
        }
      }
    }
  }
  PlotCommand parts(script);
  addObstacles(parts, motion);
  parts.add(circles, kCircles);
  addPaths(parts, motion, motion.trace.size());
  addGoals(parts, motion);
  parts.add(crashes, "with points pt 2 ps 2.5 lw 2 lc rgb \"#d00000\" notitle");
  parts.add(times, "with labels font \",8\" tc rgb \"#222222\" notitle");
  plot::endFigure(script, view.size(), {file + ".png", file + ".svg"}, parts.text());
}

}  // namespace

void drawComparison(const Evaluation& evaluation, const std::vector<Score>& scores,
                    const std::filesystem::path& folder) {
  GnuplotScript script;
  const std::size_t groups = evaluation.suite.groups.size();
  const plot::CanvasSize size{
      static_cast<int>(std::clamp<std::size_t>(kPageLeft + kPageRight + 150 * groups, 900, 2400)),
      640};
  std::vector<std::string> names;
  bool crowded = false;
  for (std::size_t i = 0; i < groups; ++i) {
    const double room_px =
        static_cast<double>(size.width - kPageLeft - kPageRight) / static_cast<double>(groups);
    crowded = crowded ||
              kLetter_px * static_cast<double>(evaluation.suite.groups[i].name.size()) > room_px;
    names.push_back(fmt::format("{} {}", gnuplotString(evaluation.suite.groups[i].name), i));
  }
  for (const bool bitmap : {true, false}) {
    plot::beginPage(script, size, bitmap, folder / "comparison");
    script.line("set multiplot");
    script.line("set label 1 {} at screen 0.5, screen 0.97 center font \",14\"",
                gnuplotString(fmt::format("{}, rules \"{}\" (lower is better)",
                                          evaluation.suite.name, evaluation.rules.name)));
    script.line("set xrange [-0.6:{:.1f}]", static_cast<double>(groups) - 0.4);
    script.line("set xtics ({}) {}", fmt::join(names, ", "), crowded ? "rotate by 25 right" : "");
    script.line("set yrange [0:*]");
    script.line("set lmargin at screen {:.3f}", static_cast<double>(kPageLeft) / size.width);
    script.line("set rmargin at screen {:.3f}", 1.0 - static_cast<double>(kPageRight) / size.width);
    script.line("set tmargin at screen 0.92");
    script.line("set bmargin at screen {}", crowded ? 0.6 : 0.53);
    script.line(
        "set key at screen {:.3f}, screen 0.92 left top Left reverse noenhanced font \",9\"",
        1.0 - (kPageRight - 10.0) / size.width);
    script.line("set ylabel \"failed: collision, stuck (paler)  %\"");
    script.line("{}", failurePanel(script, evaluation, scores));
    script.line("set ylabel \"extra time: mean, 75, 90 %  s\"");
    script.line("set key off");
    script.line("unset label 1");
    script.line("set tmargin at screen 0.45");
    script.line("set bmargin at screen {}", crowded ? 0.18 : 0.1);
    script.line("{}", timePanel(script, evaluation, scores));
    script.line("unset multiplot");
    script.line("set output");
  }
  script.run();
}

std::string drawTrajectories(const Evaluation& evaluation, std::size_t row,
                             const std::filesystem::path& folder) {
  const std::vector<Motion> motions = flyAgain(evaluation, row);
  const std::string name = fileNameOf(evaluation, row);
  GnuplotScript script;
  for (std::size_t leg = 0; leg < motions.size(); ++leg) {
    const std::string number = motions.size() > 1 ? fmt::format("_{}", leg + 1) : "";
    const std::string title =
        titleOf(evaluation, row) + (motions.size() > 1 ? fmt::format(", goals {}", leg + 1) : "");
    drawLeg(script, motions[leg], title, (folder / (name + number)).string());
  }
  script.run();
  return name;
}

std::string animate(const Evaluation& evaluation, std::size_t row,
                    const std::filesystem::path& folder) {
  const std::vector<Motion> motions = flyAgain(evaluation, row);
  plot::PlanView view;
  for (const Motion& motion : motions) {
    include(view, motion);
  }
  const std::string name = fileNameOf(evaluation, row) + ".gif";
  GnuplotScript script;
  plot::beginAnimation(script, view.size(), kFramesPerSecond, folder / name,
                       titleOf(evaluation, row));
  double time_s = 0.0;
  for (const Motion& motion : motions) {
    const std::size_t end = motion.trace.size() + kHoldFrames;
    const auto stride = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround(1.0 / (kFramesPerSecond * motion.step_s))));
    for (std::size_t frame = 0; frame < end; frame += stride) {
      const std::size_t step = std::min(frame, motion.trace.size() - 1);
      view.set(script, fmt::format("{:.1f} s", time_s + static_cast<double>(step) * motion.step_s));
      std::vector<std::string> circles;
      for (std::size_t i = 0; i < motion.agents.size(); ++i) {
        circles.push_back(circleRow(motion, step, i, motion.trace[step][i].done ? 0.5 : 0.0));
      }
      PlotCommand parts(script);
      addObstacles(parts, motion);
      addPaths(parts, motion, step + 1);
      addGoals(parts, motion);
      parts.add(circles, kCircles);
      script.line("{}", parts.text());
    }
    time_s += static_cast<double>(motion.trace.size() - 1) * motion.step_s;
  }
  script.line("set output");
  script.run();
  return name;
}

}  // namespace roundabout::learning
