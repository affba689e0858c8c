#include "sim/pedestrians/pedestrian.h"

#include <cmath>
#include <numbers>

#include "common/core/angles.h"

namespace roundabout::sim {

namespace {

constexpr double kStrideM = 1.4;
constexpr double kStrideSpeedMps = 1.4;
constexpr double kHalfHipM = 0.1;
// A body turns with its course, but not at once.
constexpr double kTurnTimeS = 0.2;

double strideOf(double speed_mps) { return kStrideM * std::sqrt(speed_mps / kStrideSpeedMps); }

}  // namespace

void walk(Pedestrian& person, double step_s) {
  const double speed_mps = person.velocity_mps.norm();
  if (speed_mps < kPedestrianStandsMps) {
    return;
  }
  const double course_rad = std::atan2(person.velocity_mps.y(), person.velocity_mps.x());
  const double left_rad = core::wrapToPi(course_rad - person.heading_rad);
  person.heading_rad =
      core::wrapToPi(person.heading_rad + (1.0 - std::exp(-step_s / kTurnTimeS)) * left_rad);
  person.gait_rad =
      std::fmod(person.gait_rad + 2.0 * std::numbers::pi * speed_mps * step_s / strideOf(speed_mps),
                2.0 * std::numbers::pi);
}

std::array<Eigen::Vector2d, 2> legsOf(const Pedestrian& person) {
  const double speed_mps = person.velocity_mps.norm();
  const double swing_m = speed_mps < kPedestrianStandsMps
                             ? 0.0
                             : 0.25 * strideOf(speed_mps) * std::sin(person.gait_rad);
  const Eigen::Vector2d ahead(std::cos(person.heading_rad), std::sin(person.heading_rad));
  const Eigen::Vector2d leftwards(-ahead.y(), ahead.x());
  return {person.position_m + kHalfHipM * leftwards + swing_m * ahead,
          person.position_m - kHalfHipM * leftwards - swing_m * ahead};
}

}  // namespace roundabout::sim
