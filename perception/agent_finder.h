#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/config/experiment.h"
#include "perception/clustering/clusterer.h"
#include "perception/detection.h"
#include "perception/tracking/tracker.h"

namespace roundabout::perception {

/// What is known of the world that does not move.
class StaticWorld {
 public:
  virtual ~StaticWorld() = default;
  /// Whether something that does not move stands here, world.
  virtual bool occupied(const Eigen::Vector2d& position_m) const = 0;
};

/// From sweeps to tracks: points, segments, clusters, detections, tracker. Knows no wire, no clock.
class AgentFinder {
 public:
  AgentFinder(const config::Perception& settings, std::unique_ptr<Clusterer> clusterer);

  /// One sweep, measured between two poses. `world`: nullptr: nothing is known. Returns how many
  /// ranges were not usable. Precondition: later than the one before.
  int update(const core::LaserScan& scan, const PlanarPose& begin, const PlanarPose& end,
             const StaticWorld* world);
  /// The next sweep is of another time or place.
  void forget();

  Tracker& tracker() { return tracker_; }
  const Tracker& tracker() const { return tracker_; }
  const ScanPoints& points() const { return points_; }
  std::span<const Detection> detections() const { return detections_; }
  /// Of the last sweep's beams, those that hit what is no agent: too wide, or known to stand there.
  std::vector<std::size_t> staticBeams() const { return static_beams_; }

 private:
  void sortSegments(const StaticWorld* world);
  bool isKnown(const Segment& segment, const StaticWorld* world) const;

  config::Perception settings_;
  std::unique_ptr<Clusterer> clusterer_;
  Tracker tracker_;
  ScanPoints points_;
  std::vector<Segment> segments_;
  std::vector<Detection> detections_;
  std::vector<std::size_t> static_beams_;
};

}  // namespace roundabout::perception
