#include "logs/report/player.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "common/plot/palette.h"
#include "logs/metrics/metrics_text.h"
#include "logs/metrics/separation.h"
#include "logs/report/player_page.h"

namespace roundabout::logs {

namespace {

using Json = nlohmann::ordered_json;

// Between frames the page draws straight lines.
constexpr double kFramesPerSecond = 20.0;
constexpr std::size_t kMostFrames = 12'000;

int millimetres(double metres) { return static_cast<int>(std::lround(metres * 1e3)); }

double rounded(double value) { return std::round(value * 1e3) / 1e3; }

/// Frames that the page gets.
std::vector<std::size_t> framesOf(const Flight& flight) {
  const double duration_s = flight.secondsAt(flight.frames.back().utime);
  const double period_s =
      std::max(1.0 / kFramesPerSecond, duration_s / static_cast<double>(kMostFrames));
  std::vector<std::size_t> frames;
  double next_s = 0.0;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    const double at_s = flight.secondsAt(flight.frames[i].utime);
    if (at_s + 1e-6 >= next_s || i + 1 == flight.frames.size()) {
      frames.push_back(i);
      next_s = at_s + period_s;
    }
  }
  return frames;
}

Json placesOf(const FlightVehicle& vehicle, const std::vector<std::size_t>& frames) {
  Json places = Json::array();
  for (const std::size_t frame : frames) {
    const Sample& sample = vehicle.samples[frame];
    if (!sample.tracked) {
      places.push_back(nullptr);
      continue;
    }
    const Eigen::Vector3d& at = sample.position_world_m;
    places.push_back({millimetres(at.x()), millimetres(at.y()), millimetres(at.z()),
                      millimetres(sample.velocity_world_mps.norm())});
  }
  return places;
}

Json modesOf(const Flight& flight, const FlightVehicle& vehicle) {
  Json modes = Json::array();
  const PlannerStatus* last = nullptr;
  for (const Logged<PlannerStatus>& status : vehicle.statuses) {
    if (status.value.utime == 0 || (last != nullptr && last->mode == status.value.mode &&
                                    last->reason == status.value.reason)) {
      continue;
    }
    last = &status.value;
    modes.push_back({rounded(flight.secondsAt(last->utime)), nameOf(last->mode), last->reason});
  }
  return modes;
}

Json goalsOf(const Flight& flight, const FlightVehicle& vehicle) {
  Json goals = Json::array();
  for (const Logged<core::Goal>& goal : vehicle.goals) {
    goals.push_back({rounded(flight.secondsAt(goal.value.utime)),
                     millimetres(goal.value.position_world_m.x()),
                     millimetres(goal.value.position_world_m.y())});
  }
  return goals;
}

Json gapsOf(const Flight& flight, const std::vector<std::size_t>& frames) {
  const GapsOverTime gaps = gapsOverTime(flight);
  Json values = Json::array();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::size_t end = i + 1 < frames.size() ? frames[i + 1] : flight.frames.size();
    const double gap_m = closestIn(flight, gaps, frames[i], end).gap_m;
    values.push_back(std::isfinite(gap_m) ? Json(millimetres(gap_m)) : Json(nullptr));
  }
  return values;
}

class Events {
 public:
  void add(double at_s, const std::string& text, const char* look = "") {
    events_.push_back({at_s, text, look});
  }
  Json sorted() {
    std::stable_sort(events_.begin(), events_.end(),
                     [](const Event& a, const Event& b) { return a.at_s < b.at_s; });
    Json list = Json::array();
    for (const Event& event : events_) {
      list.push_back({rounded(event.at_s), event.text, event.look});
    }
    return list;
  }

 private:
  struct Event {
    double at_s;
    std::string text;
    const char* look;
  };
  std::vector<Event> events_;
};

Json eventsOf(const Flight& flight, const Metrics& metrics) {
  Events events;
  for (const PhaseMetrics& phase : metrics.phases) {
    events.add(phase.begin_at_s, fmt::format("fleet: {}{}{}", nameOf(phase.phase),
                                             phase.formation.empty() ? "" : " ", phase.formation));
  }
  for (const FormationMetrics& formation : metrics.formations) {
    if (formation.formed) {
      events.add(formation.begin_at_s + formation.time_to_form_s, formation.name + " formed",
                 "good");
    }
  }
  for (const Encounter& touch : metrics.separation.touches) {
    events.add(touch.begin_at_s, fmt::format("{} and {} touch", touch.vehicle_a, touch.vehicle_b),
               "bad");
  }
  for (const Encounter& approach : metrics.separation.approaches) {
    events.add(
        approach.begin_at_s,
        fmt::format("{} and {} closer than assumed radii", approach.vehicle_a, approach.vehicle_b),
        "warn");
  }
  for (const ClosestGap& touch : metrics.obstacles.touches) {
    events.add(touch.at_s, fmt::format("{} touches {}", touch.vehicle_a, touch.vehicle_b), "bad");
  }
  for (const Silence& silence : metrics.faults.silences) {
    events.add(silence.begin_at_s, describe(silence), "warn");
  }
  for (const SafetyOrderSeen& order : metrics.faults.safety_orders) {
    events.add(order.at_s,
               fmt::format("ordered to {}: {}", order.order,
                           order.vehicle.empty() ? "all" : order.vehicle),
               "warn");
  }
  for (const FlightVehicle& vehicle : flight.vehicles) {
    PlannerMode last = PlannerMode::kWaiting;
    for (const Logged<PlannerStatus>& status : vehicle.statuses) {
      const PlannerMode mode = status.value.mode;
      const bool fault = mode == PlannerMode::kHolding || mode == PlannerMode::kKilled;
      if (fault && mode != last) {
        events.add(flight.secondsAt(status.value.utime),
                   fmt::format("{} {}: {}", vehicle.name, nameOf(mode), status.value.reason),
                   "warn");
      }
      last = mode;
    }
  }
  return events.sorted();
}

Json roomOf(const Flight& flight) {
  if (!flight.experiment) {
    return nullptr;
  }
  const auto& room = flight.experiment->room;
  return {millimetres(room.min_m.x()), millimetres(room.min_m.y()), millimetres(room.max_m.x()),
          millimetres(room.max_m.y())};
}

Json obstaclesOf(const Flight& flight) {
  Json obstacles = Json::array();
  if (!flight.experiment) {
    return obstacles;
  }
  for (const auto& obstacle : flight.experiment->obstacles) {
    Json corners = Json::array();
    for (const auto& corner : obstacle.points_m) {
      corners.push_back({millimetres(corner.x()), millimetres(corner.y())});
    }
    obstacles.push_back(corners);
  }
  return obstacles;
}

Json dataOf(const Flight& flight, const Metrics& metrics) {
  const std::vector<std::size_t> frames = framesOf(flight);
  Json data;
  Json& times = data["t"] = Json::array();
  for (const std::size_t frame : frames) {
    times.push_back(rounded(flight.secondsAt(flight.frames[frame].utime)));
  }
  Json& vehicles = data["vehicles"] = Json::array();
  for (std::size_t i = 0; i < flight.vehicles.size(); ++i) {
    const FlightVehicle& vehicle = flight.vehicles[i];
    vehicles.push_back({{"name", vehicle.name},
                        {"color", plot::hex(plot::vehicleColor(i, flight.vehicles.size()))},
                        {"body", millimetres(vehicle.body_radius_m)},
                        {"assumed", millimetres(vehicle.assumed_radius_m)},
                        {"places", placesOf(vehicle, frames)},
                        {"modes", modesOf(flight, vehicle)},
                        {"goals", goalsOf(flight, vehicle)}});
  }
  data["gaps"] = gapsOf(flight, frames);
  data["events"] = eventsOf(flight, metrics);
  data["room"] = roomOf(flight);
  data["obstacles"] = obstaclesOf(flight);
  return data;
}

/// JSON that cannot end a script element.
std::string scriptSafe(std::string text) {
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at)) {
    text.replace(at, 2, "<\\/");
  }
  return text;
}

}  // namespace

std::string playerHtml(const Flight& flight, const Metrics& metrics) {
  if (flight.frames.empty()) {
    return "";
  }
  const std::string data =
      dataOf(flight, metrics).dump(-1, ' ', false, Json::error_handler_t::replace);
  return std::string(kPlayerBody) + "<script id=\"flight\" type=\"application/json\">" +
         scriptSafe(data) + "</script>\n<script>" + kPlayerScript + "</script>\n";
}

}  // namespace roundabout::logs
