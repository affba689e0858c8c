#include "learning/evaluation/crossing/crossing_figure.h"

#include <algorithm>
#include <map>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "common/config/obstacles.h"
#include "common/plot/canvas.h"
#include "common/plot/palette.h"
#include "common/plot/plan_view.h"
#include "common/plot/plot_command.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;
using plot::Color;

constexpr double kCirclesEvery_s = 0.8;
constexpr double kTimesEvery_s = 3.2;
constexpr double kNumbersApart_m = 0.6;  // of somebody who stands
constexpr double kStarRadius_m = 0.2;
constexpr double kMargin_m = 1.5;  // around the robot's way
// Of the robot at that moment: who is farther is not drawn.
constexpr double kNear_m = 2.5;
constexpr Color kRobot{0, 90, 181};
constexpr Color kPerson{216, 92, 20};
constexpr const char* kCircles =
    "with circles lc rgb variable fs solid border lc rgb \"#777777\" notitle";

struct Drawing {
  std::vector<std::string> people;
  std::vector<std::string> robot;
  std::vector<std::string> way;
  std::vector<std::string> times;
};

Eigen::AlignedBox2d around(const CrossingTrace& trace) {
  Eigen::AlignedBox2d box(trace.goal_m);
  for (const CrossingTrace::Moment& moment : trace.moments) {
    box.extend(moment.robot_m);
  }
  const Vector2d margin = Vector2d::Constant(kMargin_m);
  return {box.min() - margin, box.max() + margin};
}

std::string circle(const Vector2d& at_m, double radius_m, const Color& color, double lightness) {
  return fmt::format("{:.3f} {:.3f} {:.3f} {}", at_m.x(), at_m.y(), radius_m,
                     plot::rgbNumber(plot::mix(color, plot::kWhite, lightness)));
}

std::string number(const Vector2d& at_m, double time_s) {
  return fmt::format("{:.3f} {:.3f} \"{:.0f}\"", at_m.x(), at_m.y(), time_s);
}

Drawing drawingOf(const config::Experiment& experiment, const CrossingTrace& trace) {
  Drawing drawing;
  const double end_s = std::max(trace.moments.back().time_s, kCirclesEvery_s);
  std::map<std::int32_t, Vector2d> numbered_m;  // where a person's last number stands
  double next_circle_s = 0.0;
  double next_time_s = 0.0;
  for (const CrossingTrace::Moment& moment : trace.moments) {
    drawing.way.push_back(fmt::format("{:.3f} {:.3f}", moment.robot_m.x(), moment.robot_m.y()));
    if (moment.time_s < next_circle_s) {
      continue;
    }
    next_circle_s += kCirclesEvery_s;
    const bool timed = moment.time_s >= next_time_s;
    next_time_s += timed ? kTimesEvery_s : 0.0;
    const double lightness = 0.85 * moment.time_s / end_s;
    for (const CrossingTrace::Person& person : moment.people) {
      if ((person.position_m - moment.robot_m).norm() < kNear_m) {
        drawing.people.push_back(
            circle(person.position_m, experiment.pedestrians.body_radius_m, kPerson, lightness));
        const auto last = numbered_m.find(person.id);
        if (timed && (last == numbered_m.end() ||
                      (last->second - person.position_m).norm() > kNumbersApart_m)) {
          drawing.times.push_back(number(person.position_m, moment.time_s));
          numbered_m[person.id] = person.position_m;
        }
      }
    }
    drawing.robot.push_back(
        circle(moment.robot_m, experiment.vehicles.front().body_radius_m, kRobot, lightness));
    if (timed) {
      drawing.times.push_back(number(moment.robot_m, moment.time_s));
    }
  }
  return drawing;
}

}  // namespace

void drawCrossing(const config::Experiment& experiment, const CrossingTrace& trace,
                  const std::string& title, const std::filesystem::path& file) {
  if (trace.moments.empty()) {
    return;
  }
  const Eigen::AlignedBox2d box = around(trace);
  plot::PlanView view;
  view.include(box.min(), 0.0);
  view.include(box.max(), 0.0);
  plot::GnuplotScript script;
  plot::beginFigure(script, view.size(), title);
  view.set(script,
           "robot blue, people near it orange, lighter with time; numbers: s; cross: collision");
  const Drawing drawing = drawingOf(experiment, trace);
  plot::PlotCommand parts(script);
  for (const core::Polygon& obstacle : config::outlinesOf(experiment.obstacles)) {
    parts.add(plot::outlineRows(obstacle), plot::kObstacleStyle);
  }
  parts.add(drawing.people, kCircles);
  parts.add(drawing.robot, kCircles);
  parts.add(drawing.way, fmt::format("with lines lw 1.4 lc rgb \"{}\" notitle",
                                     plot::hex(plot::mix(kRobot, plot::kBlack, 0.3))));
  parts.add(plot::starRows(trace.goal_m, kStarRadius_m),
            fmt::format("with filledcurves closed fc rgb \"{}\" fs solid border lc rgb \"white\" "
                        "notitle",
                        plot::hex(kRobot)));
  std::vector<std::string> collisions;
  for (const Vector2d& at_m : trace.collisions_m) {
    collisions.push_back(fmt::format("{:.3f} {:.3f}", at_m.x(), at_m.y()));
  }
  parts.add(collisions, "with points pt 2 ps 2.5 lw 2 lc rgb \"#d00000\" notitle");
  parts.add(drawing.times, "with labels font \",8\" tc rgb \"#222222\" notitle");
  plot::endFigure(script, view.size(), {file.string() + ".png", file.string() + ".svg"},
                  parts.text());
  script.run();
}

}  // namespace roundabout::learning
