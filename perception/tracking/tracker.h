#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/agent_tracks.h"
#include "perception/detection.h"
#include "perception/tracking/person_filter.h"

namespace roundabout::perception {

/// One body that is followed.
struct Track {
  std::int32_t id;
  PersonFilter filter;
  core::Utime born;
  core::Utime last_seen;
  Eigen::Vector2d born_at_m;
  int hits = 1;            ///< scans that showed it
  double existence = 0.3;  ///< 0 to 1, that there is somebody
  bool confirmed = false;
  bool moved = false;              ///< it has walked away from where it was first seen
  double leg_share = 0.0;          ///< of its scans that showed two legs or one, lately
  double half_width_m = 0.1;       ///< of what is seen of it, lately
  double camera_person = 0.0;      ///< -1 to 1: what cameras say, lately
  bool vehicle = false;            ///< it is where another vehicle of the experiment is
  core::Utime together_since = 0;  ///< with an older one in one place; 0: alone
};

/// Detections become tracks: gated optimal assignment, constant-velocity filters, birth after
/// several sightings, death when what should be seen is not.
class Tracker {
 public:
  explicit Tracker(const config::Perception& settings);

  /// Where confirmed tracks are expected at a time, world.
  std::vector<Eigen::Vector2d> expectedAt(core::Utime utime) const;

  /// One sweep. Precondition: later than the one before.
  void update(const ScanPoints& points, std::span<const Detection> detections);

  core::AgentClass classOf(const Track& track) const;
  /// Confirmed ones as the wire has them.
  std::vector<core::AgentTrack> tracks() const;
  const std::vector<Track>& all() const { return tracks_; }
  std::vector<Track>& all() { return tracks_; }
  void forget() { tracks_.clear(); }

 private:
  std::vector<std::size_t> assign(std::span<const Detection> detections) const;
  void see(Track& track, const Detection& detection, double step_s);
  void miss(Track& track, const ScanPoints& points, double step_s);
  void begin(const Detection& detection, core::Utime utime);
  bool somebodyNear(const Eigen::Vector2d& position_m, core::Utime utime) const;
  void endDoubles(core::Utime utime);

  config::Perception settings_;
  core::Utime now_ = 0;
  std::int32_t next_id_ = 1;
  std::vector<Track> tracks_;
};

}  // namespace roundabout::perception
