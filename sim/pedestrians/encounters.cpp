#include "sim/pedestrians/encounters.h"

#include <algorithm>
#include <utility>

namespace roundabout::sim {

Encounters::Encounters(std::vector<double> vehicle_radii_m, double person_radius_m)
    : radii_m_(std::move(vehicle_radii_m)), person_radius_m_(person_radius_m) {}

void Encounters::update(core::Utime now, std::span<const BodyState> bodies,
                        std::span<const Pedestrian> people) {
  still_open_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Eigen::Vector2d place_m = bodies[i].position_world_m.head<2>();
    for (const Pedestrian& person : people) {
      const Eigen::Vector2d apart = person.position_m - place_m;
      const double distance_m = apart.norm();
      const double gap_m = distance_m - radii_m_[i] - person_radius_m_;
      closest_m_ = std::min(closest_m_, gap_m);
      if (gap_m >= 0.0) {
        continue;
      }
      const std::pair pair(i, person.id);
      still_open_.push_back(pair);
      if (std::find(open_.begin(), open_.end(), pair) == open_.end()) {
        const Eigen::Vector2d towards =
            distance_m > 0.0 ? Eigen::Vector2d(apart / distance_m) : Eigen::Vector2d::UnitX();
        encounters_.push_back({i, person.id, now,
                               bodies[i].velocity_world_mps.head<2>().dot(towards),
                               -person.velocity_mps.dot(towards)});
      }
    }
  }
  std::swap(open_, still_open_);
}

}  // namespace roundabout::sim
