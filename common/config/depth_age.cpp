#include "common/config/depth_age.h"

namespace roundabout::config {

double oldestDepthsS(const Vehicle& vehicle, const Camera& camera, const Perception& perception) {
  const double between_pictures_s = perception.image_period_s + 2.0 / camera.rate_hz;
  const double in_the_map_s = 2.0 / perception.map_rate_hz + 1.0 / perception.map_publish_hz;
  return between_pictures_s + perception.image_delay_s + 2.0 / vehicle.lidar->rate_hz +
         in_the_map_s;
}

}  // namespace roundabout::config
