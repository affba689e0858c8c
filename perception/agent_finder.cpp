#include "perception/agent_finder.h"

#include <algorithm>
#include <iterator>

namespace roundabout::perception {

namespace {

// Of a segment's points, so that it is a piece of what stands there.
constexpr double kMostlyKnown = 0.7;

}  // namespace

AgentFinder::AgentFinder(const config::Perception& settings, std::unique_ptr<Clusterer> clusterer)
    : settings_(settings), clusterer_(std::move(clusterer)), tracker_(settings) {}

int AgentFinder::update(const core::LaserScan& scan, const PlanarPose& begin, const PlanarPose& end,
                        const StaticWorld* world) {
  const int unusable = toPoints(scan, begin, end, {.max_m = settings_.max_range_m}, points_);
  findSegments(points_, {.range_noise_m = settings_.range_noise_m}, segments_);
  sortSegments(world);
  const std::vector<Eigen::Vector2d> expected_m = tracker_.expectedAt(scan.utime);
  detections_.clear();
  for (const Cluster& cluster : clusterer_->cluster(points_, segments_, expected_m)) {
    detections_.push_back(detectionOf(points_, segments_, cluster));
  }
  tracker_.update(points_, detections_);
  return unusable;
}

void AgentFinder::forget() {
  tracker_.forget();
  clusterer_->forget();
}

/// Leaves those that may be agents.
void AgentFinder::sortSegments(const StaticWorld* world) {
  static_beams_.clear();
  std::vector<Segment> kept;
  for (Segment& segment : segments_) {
    const bool known = isKnown(segment, world);
    std::vector<Segment> legs;
    if (!known && segment.width_m > settings_.widest_body_m) {
      legs = legsOf(points_, segment, kWidestLeg_m);
    }
    if (known || (segment.width_m > settings_.widest_body_m && legs.empty())) {
      static_beams_.insert(static_beams_.end(), segment.beams.begin(), segment.beams.end());
    } else if (legs.empty()) {
      kept.push_back(std::move(segment));
    } else {
      std::move(legs.begin(), legs.end(), std::back_inserter(kept));
    }
  }
  segments_ = std::move(kept);
}

/// Whether it is a piece of what is known to stand there.
bool AgentFinder::isKnown(const Segment& segment, const StaticWorld* world) const {
  if (world == nullptr) {
    return false;
  }
  const auto known =
      std::count_if(segment.beams.begin(), segment.beams.end(),
                    [&](std::size_t beam) { return world->occupied(points_.world_m[beam]); });
  return static_cast<double>(known) >= kMostlyKnown * static_cast<double>(segment.beams.size());
}

}  // namespace roundabout::perception
