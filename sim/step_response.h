#pragma once

// How a model answers a step, measured as one would measure a real vehicle: from its motion alone.

#include <vector>

#include "common/config/experiment.h"

namespace roundabout::sim {

enum class StepKind { kVelocity, kPosition, kHeading };

struct StepSample {
  double time_s;    ///< since the command arrived
  double response;  ///< m/s, m or rad
  double tilt_rad;
  double acceleration_mps2;  ///< along the step, but for a heading step
};

struct StepFigures {
  double delay_s;    ///< until 5 % of the step
  double lag_s;      ///< until 63 % of the step
  double rise_s;     ///< from 10 % to 90 %
  double settled_s;  ///< within 5 % from here on
  double overshoot;  ///< share of the step
  double steady;     ///< response at the end, share of the step
  double max_tilt_rad;
  double max_acceleration_mps2;
  double max_jerk_mps3;
};

/// A step of this size (m/s, m or rad; forward) from hovering at 1 m with the heading along x.
/// Every world step for duration_s.
std::vector<StepSample> stepResponse(const config::Sim& sim, StepKind kind, double size,
                                     double duration_s);

/// How far it goes on from level flight at this speed after a HOLD command arrived. m.
double stoppingDistanceM(const config::Sim& sim, double speed_mps);

StepFigures figuresOf(const std::vector<StepSample>& response, double size);

}  // namespace roundabout::sim
