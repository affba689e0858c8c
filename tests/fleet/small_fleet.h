#pragma once

#include <string>

#include <spdlog/fmt/fmt.h>

#include "common/config/experiment.h"

namespace roundabout::fleet {

/// `count` vehicles v1, v2, … in a room of 40 m by 40 m, with an assumed radius of 0.5 m.
inline config::Experiment smallFleet(int count = 3) {
  config::Experiment experiment;
  experiment.file = "test.yaml";
  experiment.room.min_m = {-20.0, -20.0, 0.0};
  experiment.room.max_m = {20.0, 20.0, 4.0};
  for (int i = 1; i <= count; ++i) {
    config::Vehicle vehicle;
    vehicle.name = fmt::format("v{}", i);
    experiment.vehicles.push_back(vehicle);
  }
  return experiment;
}

inline config::MissionStep verb(const std::string& name, const std::string& text = "") {
  config::MissionStep step;
  step.verb = name;
  step.text = text;
  return step;
}

inline config::MissionStep formation(const std::string& name,
                                     std::vector<Eigen::Vector3d> points_m) {
  config::MissionStep step = verb("formation", name);
  step.points_m = std::move(points_m);
  return step;
}

}  // namespace roundabout::fleet
