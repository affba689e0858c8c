#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/vehicle_state.h"

namespace roundabout::planner {

/// One vehicle as the planner believes it to be: the last measurement that was physically possible,
/// and its age.
class Track {
 public:
  Track(double top_speed_mps, const config::Safety& safety);

  /// A measurement of a frame at `utime` that is marked tracked. False if it was rejected: it jumps
  /// farther than the top speed allows, or its velocity is more than twice that. After
  /// safety.max_rejects_in_a_row of those the track is lost; as many that agree with each other
  /// start it anew.
  bool update(const core::VehicleState& measured, core::Utime utime);

  /// Counts a measurement that the caller found impossible for other reasons.
  void reject();

  bool seen() const { return last_accepted_ > 0; }
  bool lost() const { return rejects_in_a_row_ >= max_rejects_; }
  /// s since the last accepted measurement; infinite if there is none or the track is lost.
  double ageS(core::Utime now) const;
  /// s since the last accepted measurement, lost or not. Precondition: seen().
  double sinceAcceptedS(core::Utime now) const { return core::toSeconds(now - last_accepted_); }
  /// The last accepted measurement.
  const core::VehicleState& state() const { return state_; }
  /// Extrapolated with constant velocity, for safety.other_track_lost_s at most. m, world.
  Eigen::Vector2d positionAt(core::Utime now) const;
  int rejected() const { return rejected_; }

 private:
  double allowedJumpM(core::Utime from, core::Utime to) const;

  double top_speed_mps_;
  double jump_margin_m_;
  double longest_extrapolation_s_;
  int max_rejects_;
  core::VehicleState state_;
  core::Utime last_accepted_ = 0;
  core::VehicleState
      candidate_;  // the latest rejected measurement, from which a lost track may start anew
  core::Utime candidate_utime_ = 0;
  int candidate_run_ = 0;
  int rejects_in_a_row_ = 0;
  int rejected_ = 0;
};

/// The tracks of every vehicle of an experiment.
class TrackTable {
 public:
  explicit TrackTable(const config::Experiment& experiment);

  /// Takes a frame whose stamp is in order. Returns how many bodies in it belong to nobody.
  /// A body that appears where another vehicle is believed to be has been exchanged with it:
  /// rejected, however long that lasts, because commands would go to the wrong vehicle.
  int update(const core::StatesFrame& frame);

  const Track& at(std::size_t vehicle_index) const { return tracks_[vehicle_index]; }
  std::size_t size() const { return tracks_.size(); }
  int rejectedMeasurements() const;

 private:
  bool exchanged(std::size_t index, const core::VehicleState& measured, core::Utime utime) const;

  double jump_margin_m_;
  std::map<std::string, std::size_t> index_of_;
  std::vector<Track> tracks_;
};

}  // namespace roundabout::planner
