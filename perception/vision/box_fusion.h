#pragma once

#include <span>
#include <vector>

#include "common/config/experiment.h"
#include "perception/scan/scan_points.h"
#include "perception/tracking/tracker.h"
#include "perception/vision/person_detector.h"

namespace roundabout::perception {

/// Where a body stands in a camera's picture, as a pinhole sees it.
struct Projection {
  bool in_view = false;
  double column = 0.0;  ///< of its middle, pixels
  double bottom = 0.0;  ///< of its feet, pixels
  double top = 0.0;     ///< of the head of a person of usual height
  double distance_m = 0.0;
};

Projection project(const config::Camera& camera, const PlanarPose& vehicle,
                   const Eigen::Vector2d& feet_world_m);

/// Tells tracks what a camera saw where they stand: a box around a person's projection is one vote
/// for a pedestrian; no box where one should be is a weaker vote against it. `vehicle`: where it
/// was at the exposure.
void fuseBoxes(const config::Camera& camera, const PlanarPose& vehicle,
               std::span<const PersonBox> boxes, std::vector<Track>& tracks);

}  // namespace roundabout::perception
