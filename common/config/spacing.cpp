#include "common/config/spacing.h"

#include <algorithm>

namespace roundabout::config {

double goalSpacingM(const Experiment& experiment) {
  double largest_m = 0.0;
  double second_m = 0.0;
  for (const Vehicle& vehicle : experiment.vehicles) {
    second_m = std::max(second_m, std::min(largest_m, vehicle.assumed_radius_m));
    largest_m = std::max(largest_m, vehicle.assumed_radius_m);
  }
  return largest_m + second_m + experiment.safety.goal_margin_m;
}

double obstacleSpacingM(const Experiment& experiment) {
  double largest_m = 0.0;
  for (const Vehicle& vehicle : experiment.vehicles) {
    largest_m = std::max(largest_m, vehicle.assumed_radius_m);
  }
  return largest_m + experiment.safety.goal_margin_m;
}

double largestBodyRadiusM(const Experiment& experiment) {
  double largest_m = 0.0;
  for (const Vehicle& vehicle : experiment.vehicles) {
    largest_m = std::max(largest_m, vehicle.body_radius_m);
  }
  return largest_m;
}

}  // namespace roundabout::config
