#include "sim/contacts.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace roundabout::sim {

Contacts::Contacts(std::vector<double> body_radii_m)
    : radii_m_(std::move(body_radii_m)), open_(radii_m_.size() * radii_m_.size(), kNone) {}

void Contacts::update(core::Utime now, core::Utime step_us, std::span<const BodyState> bodies) {
  for (std::size_t j = 1; j < bodies.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const double gap =
          (bodies[i].position_world_m - bodies[j].position_world_m).head<2>().norm() - radii_m_[i] -
          radii_m_[j];
      closest_m_ = std::min(closest_m_, gap);
      int& open = open_[i * radii_m_.size() + j];
      if (gap >= 0.0) {
        open = kNone;
        continue;
      }
      if (open == kNone) {
        open = static_cast<int>(contacts_.size());
        contacts_.push_back({i, j, now, 0});
      }
      contacts_[static_cast<std::size_t>(open)].duration_us += step_us;
    }
  }
}

core::Utime Contacts::totalUs() const {
  return std::accumulate(
      contacts_.begin(), contacts_.end(), core::Utime{0},
      [](core::Utime sum, const Contact& contact) { return sum + contact.duration_us; });
}

}  // namespace roundabout::sim
