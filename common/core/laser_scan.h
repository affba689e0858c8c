#pragma once

#include <vector>

#include "common/core/time.h"

namespace roundabout::core {

/// One sweep of a vehicle's planar range finder.
struct LaserScan {
  Utime utime = 0;               ///< of the sweep
  double first_angle_rad = 0.0;  ///< of ranges_m[0], from the vehicle's heading, counter-clockwise
  double angle_step_rad = 0.0;
  std::vector<float> ranges_m;  ///< what hit nothing: the maximum range or more; NaN: not measured
};

}  // namespace roundabout::core
