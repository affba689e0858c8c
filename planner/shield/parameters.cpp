#include "planner/shield/parameters.h"

#include <algorithm>

namespace roundabout::planner::shield {

ShieldParameters ShieldParameters::idealRules() {
  ShieldParameters parameters;
  parameters.hold_s = parameters.period_s;
  parameters.margin_m = 0.005;
  parameters.keeps_heading = true;
  parameters.look_ahead_s = 0.0;
  return parameters;
}

ShieldParameters ShieldParameters::lab() {
  ShieldParameters parameters;
  parameters.breaker_horizon_s = 3.0;
  parameters.block_horizon_s = 1.5;
  parameters.slow_down_distance_m = 2.0;
  parameters.progress_time_constant_s = 1.0;
  parameters.stalled_share = 0.4;
  parameters.steps_aside = true;
  return parameters;
}

void ShieldParameters::suit(std::string_view policy) {
  if (policy == "orca" || policy == "non_cooperative") {
    progress_time_constant_s = std::min(progress_time_constant_s, 1.0);
    stalled_share = std::max(stalled_share, 0.3);
  }
}

}  // namespace roundabout::planner::shield
