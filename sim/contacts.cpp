#include "sim/contacts.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "common/core/polygon.h"

namespace roundabout::sim {

Contacts::Contacts(std::vector<double> body_radii_m, std::vector<core::Polygon> obstacles)
    : radii_m_(std::move(body_radii_m)),
      obstacles_(std::move(obstacles)),
      open_(radii_m_.size() * (radii_m_.size() + obstacles_.size()), kNone) {}

void Contacts::update(core::Utime now, core::Utime step_us, std::span<const BodyState> bodies) {
  const std::size_t columns = radii_m_.size() + obstacles_.size();
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    const Eigen::Vector2d place_m = bodies[j].position_world_m.head<2>();
    for (std::size_t i = 0; i < j; ++i) {
      const double gap_m =
          (bodies[i].position_world_m.head<2>() - place_m).norm() - radii_m_[i] - radii_m_[j];
      note(gap_m, {i, j, false, now, 0}, step_us, open_[i * columns + j]);
    }
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
      const double gap_m = core::distanceTo(obstacles_[k], place_m) - radii_m_[j];
      note(gap_m, {j, k, true, now, 0}, step_us, open_[j * columns + radii_m_.size() + k]);
    }
  }
}

void Contacts::note(double gap_m, const Contact& beginning, core::Utime step_us, int& open) {
  closest_m_ = std::min(closest_m_, gap_m);
  if (gap_m >= 0.0) {
    open = kNone;
    return;
  }
  if (open == kNone) {
    open = static_cast<int>(contacts_.size());
    contacts_.push_back(beginning);
  }
  contacts_[static_cast<std::size_t>(open)].duration_us += step_us;
}

core::Utime Contacts::totalUs() const {
  return std::accumulate(
      contacts_.begin(), contacts_.end(), core::Utime{0},
      [](core::Utime sum, const Contact& contact) { return sum + contact.duration_us; });
}

}  // namespace roundabout::sim
