#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "perception/scan/segments.h"

namespace roundabout::perception {

/// Which segments are one body: indices into the segments a clusterer was given. Every segment is
/// in one cluster, and in no other.
using Cluster = std::vector<std::size_t>;

/// Puts together what a planar lidar sees of one body, which may be two legs. Deterministic; may
/// remember what it was given before, in order of time.
class Clusterer {
 public:
  Clusterer() = default;
  Clusterer(const Clusterer&) = delete;
  Clusterer& operator=(const Clusterer&) = delete;
  virtual ~Clusterer() = default;

  /// `segments`: none wider than a body. `expected_m`: where bodies are expected that are followed
  /// already, in the world. The result is valid until the next call.
  virtual std::span<const Cluster> cluster(const ScanPoints& points,
                                           std::span<const Segment> segments,
                                           std::span<const Eigen::Vector2d> expected_m) = 0;
  /// Forgets what it remembers: the next scan is of another place or time.
  virtual void forget() {}
};

}  // namespace roundabout::perception
