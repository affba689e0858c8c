#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace roundabout::perception {

/// Somebody at one moment, true or tracked.
struct Sighting {
  std::int32_t id = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

/// CLEAR MOT (Bernardin, Stiefelhagen: Evaluating Multiple Object Tracking Performance, EURASIP
/// JIVP 2008): a track is somebody while it is nearer to them than `reach`; who was whom before
/// stays so while it can, and the rest is matched at least total distance.
class ClearMot {
 public:
  explicit ClearMot(double reach_m = 0.5) : reach_m_(reach_m) {}

  /// One moment, later than the one before.
  void add(std::span<const Sighting> truth, std::span<const Sighting> tracked);

  struct Result {
    std::int64_t truths = 0;  ///< people x moments
    std::int64_t misses = 0;
    std::int64_t false_tracks = 0;
    std::int64_t switches = 0;      ///< somebody has another id than when last matched
    double accuracy = 0.0;          ///< MOTA: 1 - (misses + false + switches) / truths
    double precision_m = 0.0;       ///< MOTP: mean distance of the matched
    double velocity_rms_mps = 0.0;  ///< length of the velocity error, of the matched
  };
  Result result() const;

 private:
  double reach_m_;
  Result sums_;
  std::int64_t matches_ = 0;
  std::map<std::int32_t, std::int32_t> track_of_;  // as last matched, by true id
};

}  // namespace roundabout::perception
