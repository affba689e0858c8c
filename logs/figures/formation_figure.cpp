#include "logs/figures/formation_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/plot/palette.h"
#include "common/plot/plan_view.h"
#include "common/plot/plot_command.h"

namespace roundabout::logs {

namespace {

using namespace plot;  // NOLINT(google-build-using-namespace): the drawing of this file

constexpr double kStarRadiusM = 0.2;
constexpr double kPathStepM = 0.03;
constexpr double kOverviewPathStepM = 0.06;
// A vehicle that has moved less than this since its last circle gets no new one.
constexpr double kCircleStepM = 0.1;
constexpr unsigned kCircleAlpha = 0x28;  // of 0xff, which is invisible

/// s. Circles this far apart in time overlap a little at preferred speed.
double circleInterval(const Flight& flight) {
  constexpr std::array<double, 6> kIntervals{0.1, 0.2, 0.5, 1.0, 2.0, 5.0};
  const FlightVehicle& vehicle = flight.vehicles.front();
  const double wanted_s = 1.2 * vehicle.body_radius_m / vehicle.preferred_speed_mps;
  for (const double interval_s : kIntervals) {
    if (interval_s >= wanted_s) {
      return interval_s;
    }
  }
  return kIntervals.back();
}

unsigned circleColor(const Color& color, double time_fraction) {
  const Color shade = time_fraction < 0.6 ? mix(kWhite, color, 0.2 + time_fraction * 0.8 / 0.6)
                                          : mix(color, kBlack, (time_fraction - 0.6) * 0.7);
  return (kCircleAlpha << 24) | static_cast<unsigned>(rgbNumber(shade));
}

/// "x y radius colour" in the order of time, so that later circles lie above earlier ones.
std::vector<std::string> circleRows(const Flight& flight, std::size_t begin, std::size_t end,
                                    double dark_at_s, double interval_s) {
  std::vector<std::string> rows;
  std::vector<const Sample*> last(flight.vehicles.size(), nullptr);
  const double begin_s = flight.secondsAt(flight.frames[begin].utime);
  const double span_s = std::max(dark_at_s - begin_s, interval_s);
  for (int k = 0;; ++k) {
    const double at_s = begin_s + k * interval_s;
    const std::size_t frame = flight.frameAt(flight.utimeAt(at_s));
    if (frame >= end) {
      return rows;
    }
    for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
      const FlightVehicle& vehicle = flight.vehicles[i];
      const Sample& sample = vehicle.samples[frame];
      const bool moved =
          last[i] == nullptr ||
          (sample.position_world_m - last[i]->position_world_m).norm() >= kCircleStepM;
      if (sample.tracked && moved) {
        last[i] = &sample;
        const double fraction = std::min((at_s - begin_s) / span_s, 1.0);
        rows.push_back(fmt::format("{:.3f} {:.3f} {:.3f} {}", sample.position_world_m.x(),
                                   sample.position_world_m.y(), vehicle.body_radius_m,
                                   circleColor(vehicleColor(i, flight.vehicles.size()), fraction)));
      }
    }
  }
}

/// The first tracked sample in [begin, end); nullptr if there is none.
const Sample* firstTracked(const FlightVehicle& vehicle, std::size_t begin, std::size_t end) {
  for (std::size_t frame = begin; frame < end; ++frame) {
    if (vehicle.samples[frame].tracked) {
      return &vehicle.samples[frame];
    }
  }
  return nullptr;
}

void includePaths(PlanView& view, const Flight& flight, std::size_t begin, std::size_t end) {
  for (const FlightVehicle& vehicle : flight.vehicles) {
    for (std::size_t frame = begin; frame < end; ++frame) {
      if (vehicle.samples[frame].tracked) {
        view.include(vehicle.samples[frame].position_world_m.head<2>(), vehicle.body_radius_m);
      }
    }
  }
}

/// "x y" of the tracked samples [begin, end), no closer together than step_m; an empty row where
/// the vehicle was not tracked.
std::vector<std::string> pathRows(const FlightVehicle& vehicle, std::size_t begin, std::size_t end,
                                  double step_m) {
  std::vector<std::string> rows;
  const Sample* last = nullptr;
  for (std::size_t frame = begin; frame < end; ++frame) {
    const Sample& sample = vehicle.samples[frame];
    if (!sample.tracked) {
      if (last != nullptr) {
        rows.emplace_back();
      }
      last = nullptr;
    } else if (last == nullptr ||
               (sample.position_world_m - last->position_world_m).norm() >= step_m) {
      rows.push_back(
          fmt::format("{:.3f} {:.3f}", sample.position_world_m.x(), sample.position_world_m.y()));
      last = &sample;
    }
  }
  return rows;
}

const std::vector<config::Obstacle>& obstaclesOf(const Flight& flight) {
  static const std::vector<config::Obstacle> kNone;
  return flight.experiment ? flight.experiment->obstacles : kNone;
}

void includeObstacles(PlanView& view, const Flight& flight) {
  for (const config::Obstacle& obstacle : obstaclesOf(flight)) {
    for (const Eigen::Vector2d& corner : obstacle.points_m) {
      view.include(corner, 0.0);
    }
  }
}

void addObstacles(PlotCommand& plot, const Flight& flight) {
  for (const config::Obstacle& obstacle : obstaclesOf(flight)) {
    plot.add(outlineRows(obstacle.points_m), kObstacleStyle);
  }
}

/// "x y" of each person's way in a time, an empty row between two people.
std::vector<std::string> peopleRows(const Flight& flight, core::Utime begin, core::Utime end) {
  std::map<std::int32_t, std::vector<std::string>> by_id;
  for (const PeopleFrame& frame : flight.people) {
    if (frame.utime >= begin && frame.utime <= end) {
      for (const SeenPerson& person : frame.people) {
        by_id[person.id].push_back(
            fmt::format("{:.3f} {:.3f}", person.position_m.x(), person.position_m.y()));
      }
    }
  }
  std::vector<std::string> rows;
  for (auto& [id, way] : by_id) {
    rows.insert(rows.end(), way.begin(), way.end());
    rows.emplace_back();
  }
  return rows;
}

/// "x y radius" of everybody every so often.
std::vector<std::string> peopleCircles(const Flight& flight, core::Utime begin, core::Utime end,
                                       double interval_s) {
  std::vector<std::string> rows;
  core::Utime next = begin;
  for (const PeopleFrame& frame : flight.people) {
    if (frame.utime < next || frame.utime > end) {
      continue;
    }
    next = frame.utime + core::toUtime(interval_s);
    for (const SeenPerson& person : frame.people) {
      rows.push_back(fmt::format("{:.3f} {:.3f} {:.3f}", person.position_m.x(),
                                 person.position_m.y(), person.radius_m));
    }
  }
  return rows;
}

/// Times of frames [begin, end).
void addPeople(PlotCommand& plot, const Flight& flight, std::size_t begin, std::size_t end,
               double interval_s) {
  if (flight.people.empty()) {
    return;
  }
  const core::Utime from = flight.frames[begin].utime;
  const core::Utime to = flight.frames[end - 1].utime;
  if (interval_s > 0.0) {
    plot.add(peopleCircles(flight, from, to, interval_s),
             "with circles fc rgb \"#d8b98a55\" fs solid border lc rgb \"#b08968\" notitle");
  }
  plot.add(peopleRows(flight, from, to), "with lines lw 1.0 lc rgb \"#b08968\" notitle");
  plot.addKey("with points pt 7 ps 1.8 lc rgb \"#d8b98a\"", "people");
}

void addPaths(PlotCommand& plot, const Flight& flight, std::size_t begin, std::size_t end,
              double step_m) {
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    const Color color = mix(vehicleColor(i, flight.vehicles.size()), kBlack, 0.25);
    plot.add(pathRows(flight.vehicles[i], begin, end, step_m),
             fmt::format("with lines lw 1.6 lc rgb \"{}\"", hex(color)));
  }
}

/// Where the shield had something else flown, no closer together than step_m.
void addInterventions(PlotCommand& plot, const Flight& flight, std::size_t begin, std::size_t end,
                      double step_m) {
  std::vector<std::string> rows;
  for (const FlightVehicle& vehicle : flight.vehicles) {
    const Sample* last = nullptr;
    for (const Logged<PlannerStatus>& status : vehicle.statuses) {
      const std::size_t frame = flight.frameAt(status.value.utime);
      if (status.value.shield_layer <= core::ShieldLayer::kNone || frame < begin || frame >= end) {
        continue;
      }
      const Sample& sample = vehicle.samples[frame];
      const bool moved =
          last == nullptr || (sample.position_world_m - last->position_world_m).norm() >= step_m;
      if (sample.tracked && moved) {
        last = &sample;
        rows.push_back(
            fmt::format("{:.3f} {:.3f}", sample.position_world_m.x(), sample.position_world_m.y()));
      }
    }
  }
  if (!rows.empty()) {
    plot.add(rows, "with points pt 2 ps 0.7 lw 1.5 lc rgb \"#d62728\"");
    plot.addKey("with points pt 2 ps 1 lw 1.5 lc rgb \"#d62728\"", "shield");
  }
}

void addStarts(PlotCommand& plot, const Flight& flight, std::size_t begin, std::size_t end) {
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    if (const Sample* start = firstTracked(flight.vehicles[i], begin, end)) {
      const std::vector<std::string> row{
          fmt::format("{:.3f} {:.3f}", start->position_world_m.x(), start->position_world_m.y())};
      plot.add(row, "with points pt 13 ps 1.9 lc rgb \"white\"");
      plot.add(row, fmt::format("with points pt 13 ps 1.3 lc rgb \"{}\"",
                                hex(vehicleColor(i, flight.vehicles.size()))));
    }
  }
}

void addNames(PlotCommand& plot, const Flight& flight) {
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    plot.addKey(fmt::format("with points pt 7 ps 1.8 lc rgb \"{}\"",
                            hex(vehicleColor(i, flight.vehicles.size()))),
                flight.vehicles[i].name);
  }
}

void addStar(PlotCommand& plot, const Eigen::Vector3d& goal_world_m, const Color& color) {
  plot.add(starRows(goal_world_m.head<2>(), kStarRadiusM),
           fmt::format("with filledcurves closed fc rgb \"{}\" fs solid border lc rgb \"white\"",
                       hex(color)));
}

std::size_t indexOf(const Flight& flight, const std::string& vehicle) {
  const auto found =
      std::find_if(flight.vehicles.begin(), flight.vehicles.end(),
                   [&](const FlightVehicle& candidate) { return candidate.name == vehicle; });
  return static_cast<std::size_t>(found - flight.vehicles.begin());
}

std::string outcomeOf(const FormationMetrics& formation) {
  std::string text = !formation.formed ? "not formed"
                     : std::isfinite(formation.time_to_form_s)
                         ? fmt::format("formed in {:.1f} s", formation.time_to_form_s)
                         : "formed";
  if (std::isfinite(formation.body_gap.gap_m)) {
    text += formation.body_gap.gap_m < 0.0
                ? fmt::format(", bodies overlap {:.2f} m", -formation.body_gap.gap_m)
                : fmt::format(", closest bodies {:.2f} m", formation.body_gap.gap_m);
  }
  return text;
}

}  // namespace

void drawFormation(GnuplotScript& script, const Flight& flight, const FormationMetrics& formation,
                   Figure& figure) {
  const std::size_t begin =
      std::min(flight.frameAt(flight.utimeAt(formation.begin_at_s)), flight.frames.size() - 1);
  const std::size_t end = std::max(begin + 1, flight.frameAt(flight.utimeAt(formation.end_at_s)));
  const double formed_at_s = std::isfinite(formation.time_to_form_s)
                                 ? formation.begin_at_s + formation.time_to_form_s
                                 : formation.end_at_s;
  const double interval_s = circleInterval(flight);
  figure.title = formation.name + ": " + outcomeOf(formation);
  figure.caption = fmt::format(
      "bodies every {} s while moving, darker with time; star: goal, diamond: start, red cross: "
      "the shield acted",
      interval_s);

  PlanView view;
  includePaths(view, flight, begin, end);
  includeObstacles(view, flight);
  for (const LegMetrics& leg : formation.legs) {
    view.include(leg.goal_world_m.head<2>(), kStarRadiusM);
  }
  beginFigure(script, view.size(), figure.title);
  view.set(script, figure.caption);

  PlotCommand plot(script);
  addObstacles(plot, flight);
  addPeople(plot, flight, begin, end, interval_s);
  plot.add(circleRows(flight, begin, end, formed_at_s, interval_s),
           "with circles lc rgb variable fs solid border lc rgb \"#60ffffff\"");
  addPaths(plot, flight, begin, end, kPathStepM);
  addInterventions(plot, flight, begin, end, kPathStepM);
  addStarts(plot, flight, begin, end);
  for (const LegMetrics& leg : formation.legs) {
    addStar(plot, leg.goal_world_m,
            vehicleColor(indexOf(flight, leg.vehicle), flight.vehicles.size()));
  }
  addNames(plot, flight);
  endFigure(script, view.size(), figure.files(), plot.text());
}

void drawOverview(GnuplotScript& script, const Flight& flight, const Metrics& metrics,
                  Figure& figure) {
  const std::size_t end = flight.frames.size();
  figure.title = "The whole flight";
  figure.caption = "paths of the centres; diamond: start, grey star: a goal";
  PlanView view;
  includePaths(view, flight, 0, end);
  includeObstacles(view, flight);
  beginFigure(script, view.size(), figure.title);
  view.set(script, figure.caption);
  PlotCommand plot(script);
  addObstacles(plot, flight);
  for (const FormationMetrics& formation : metrics.formations) {
    for (const LegMetrics& leg : formation.legs) {
      addStar(plot, leg.goal_world_m, {190, 190, 190});
    }
  }
  addPeople(plot, flight, 0, end, 0.0);
  addPaths(plot, flight, 0, end, kOverviewPathStepM);
  addInterventions(plot, flight, 0, end, kOverviewPathStepM);
  addStarts(plot, flight, 0, end);
  addNames(plot, flight);
  endFigure(script, view.size(), figure.files(), plot.text());
}

}  // namespace roundabout::logs
