#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "common/config/experiment.h"
#include "common/core/agent.h"
#include "common/core/agent_tracks.h"

namespace roundabout::planner {

/// Somebody whom the vehicle's own perception follows, now.
struct SeenAgent {
  /// Ids of others are the vehicles' numbers, then the tracks' beyond this.
  static constexpr int kFirstId = 1'000'000;

  int id = 0;
  Eigen::Vector2d measured_m = Eigen::Vector2d::Zero();    ///< world, age_s ago
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();    ///< world, extrapolated to now
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();  ///< zero for who stands
  double radius_m = 0.3;                                   ///< of the disc that holds it
  double uncertainty_m = 0.0;  ///< how far from there it may be: grows with age
  double age_s = 0.0;          ///< of the message
  bool stands = false;
};

/// What perception says, until planning ticks use it: as every message, tracks take effect at the
/// first tick after their utime. Nothing here believes tracks for longer than safety.tracks_hold_s.
class SeenAgents {
 public:
  SeenAgents(const config::Experiment& experiment, std::size_t own_index);

  /// Whether planner.others asks for tracks at all.
  bool used() const { return used_; }

  /// Returns why the message is refused; nullptr: it is not. newest_frame: 0 before the first.
  const char* offer(const core::AgentTracks& tracks, core::Utime newest_frame);

  /// Makes the newest tracks from before `now` those that count. Blind ones never do.
  void apply(core::Utime now);

  /// Whether there are tracks that are not too old. Precondition: apply(now).
  bool fresh() const;
  /// s since the newest tracks that were not blind; infinite: there were none.
  double ageS() const;
  /// What perception said when it was blind last, if that is newer than all tracks; else empty.
  const std::string& blindReason() const { return blind_reason_; }
  /// Everybody in the tracks that count, but for what cannot be anybody: deeper in an obstacle of
  /// the experiment, or in a wall of the room where the lidar sees those, than it may be off by;
  /// and what stands at such a surface without being a person, which is a piece of it. Nobody when
  /// they are not fresh.
  std::span<const SeenAgent> agents() const { return agents_; }

  /// The states' time went back.
  void clear();

 private:
  static constexpr std::size_t kCapacity = 16;

  SeenAgent seen(const core::AgentTrack& track, double age_s) const;
  bool canBeSomebody(const core::AgentTrack& track) const;
  double fromSurfaceM(const Eigen::Vector2d& place_m) const;

  bool used_;
  double hold_s_;
  double standing_mps_;
  bool walls_are_seen_;
  Eigen::AlignedBox2d room_;
  std::vector<core::Polygon> obstacles_;
  std::vector<core::AgentTracks> waiting_;
  core::AgentTracks current_;
  bool any_ = false;
  core::Utime now_ = 0;
  std::string blind_reason_;
  std::vector<SeenAgent> agents_;
};

}  // namespace roundabout::planner
