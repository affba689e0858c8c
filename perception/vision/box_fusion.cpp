#include "perception/vision/box_fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace roundabout::perception {

namespace {

constexpr double kPersonHeight_m = 1.7;
constexpr double kNearest_m = 0.3;
// Boxes are drawn generously, and people are tall and short.
constexpr double kSizeFactor = 1.7;
// A detector is expected to see who is at least so tall in the picture.
constexpr double kSeenFrom_px = 100.0;
constexpr double kVote = 0.3;
constexpr double kMissingVote = 0.05;

}  // namespace

Projection project(const config::Camera& camera, const PlanarPose& vehicle,
                   const Eigen::Vector2d& feet_world_m) {
  const double heading_rad = vehicle.heading_rad + camera.heading_rad;
  const Eigen::Vector2d ahead(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d ray_m = feet_world_m - vehicle.position_m;
  const double depth_m = ray_m.dot(ahead);
  const double left_m = ray_m.dot(Eigen::Vector2d(-ahead.y(), ahead.x()));
  Projection projection;
  projection.distance_m = ray_m.norm();
  if (depth_m < kNearest_m) {
    return projection;
  }
  const double focal_px = camera.width / 2.0 / std::tan(camera.field_of_view_rad / 2.0);
  projection.column = camera.width / 2.0 - focal_px * left_m / depth_m;
  projection.bottom = camera.height / 2.0 + focal_px * camera.height_m / depth_m;
  projection.top = camera.height / 2.0 - focal_px * (kPersonHeight_m - camera.height_m) / depth_m;
  projection.in_view = projection.column >= 0.0 && projection.column < camera.width;
  return projection;
}

void fuseBoxes(const config::Camera& camera, const PlanarPose& vehicle,
               std::span<const PersonBox> boxes, std::vector<Track>& tracks) {
  std::vector<bool> seen(tracks.size(), false);
  std::vector<Projection> projections;
  for (const Track& track : tracks) {
    projections.push_back(project(camera, vehicle, track.filter.position()));
  }
  for (const PersonBox& box : boxes) {
    // Who is nearest hides the others behind.
    std::size_t best = tracks.size();
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const Projection& at = projections[i];
      const double ratio = (box.bottom - box.top) / (at.bottom - at.top);
      const bool cut = at.top < 0.0 || at.bottom > camera.height;
      const bool sized = ratio < kSizeFactor && (cut || ratio > 1.0 / kSizeFactor);
      if (tracks[i].confirmed && at.in_view && at.column >= box.left && at.column <= box.right &&
          sized && at.distance_m < nearest_m) {
        nearest_m = at.distance_m;
        best = i;
      }
    }
    if (best < tracks.size()) {
      seen[best] = true;
    }
  }
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Projection& at = projections[i];
    const bool expected = at.in_view && at.bottom - at.top > kSeenFrom_px && at.top >= 0.0 &&
                          at.bottom <= camera.height;
    if (seen[i]) {
      tracks[i].camera_person += kVote * (1.0 - tracks[i].camera_person);
    } else if (expected) {
      tracks[i].camera_person += kMissingVote * (-1.0 - tracks[i].camera_person);
    }
  }
}

}  // namespace roundabout::perception
