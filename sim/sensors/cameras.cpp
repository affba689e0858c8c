#include "sim/sensors/cameras.h"

#include "common/config/obstacles.h"
#include "common/core/vehicle_state.h"
#include "sim/sensors/jpeg.h"

namespace roundabout::sim {

Cameras::Cameras(const config::Experiment& experiment, std::size_t most_bytes)
    : most_bytes_(most_bytes),
      person_height_m_(experiment.pedestrians.height_m),
      obstacles_(config::outlinesOf(experiment.obstacles)),
      room_(experiment.room.min_m.head<2>(), experiment.room.max_m.head<2>()) {
  for (std::size_t i = 0; i < experiment.vehicles.size(); ++i) {
    for (const config::Camera& camera : experiment.vehicles[i].cameras) {
      cameras_.push_back({i, CameraModel(camera), core::TickTimer(camera.rate_hz)});
    }
  }
}

std::span<const Cameras::Shot> Cameras::shoot(core::Utime now, std::span<const BodyState> bodies,
                                              std::span<const Pedestrian> people) {
  shots_.clear();
  for (Mounted& camera : cameras_) {
    if (!camera.timer.due(now)) {
      continue;
    }
    const BodyState& own = bodies[camera.vehicle];
    const config::Camera& settings = camera.model.settings();
    const std::span<const std::uint8_t> rgb =
        camera.model.render(own.position_world_m.head<2>(), core::headingOf(own.orientation),
                            {obstacles_, room_}, people, person_height_m_);
    shots_.push_back({camera.vehicle,
                      settings.name,
                      {now, settings.width, settings.height,
                       encodeJpeg(rgb, settings.width, settings.height, most_bytes_)}});
  }
  return shots_;
}

}  // namespace roundabout::sim
