#pragma once

#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/agent.h"
#include "common/core/command.h"
#include "planner/safety/seen_agents.h"
#include "planner/safety/tracks.h"

namespace roundabout::planner {

/// What a planner believes of its own vehicle and the others: a view on the tracks. Cheap to make,
/// valid as long as what it was made from.
class Situation {
 public:
  /// tracks: of VEHICLE_STATES; seen: of the vehicle's own perception.
  Situation(const config::Experiment& experiment, std::size_t own_index, const TrackTable& tracks,
            const SeenAgents& seen)
      : experiment_(experiment), own_index_(own_index), tracks_(tracks), seen_(seen) {}

  const config::Experiment& experiment() const { return experiment_; }
  const config::Vehicle& vehicle() const { return experiment_.vehicles[own_index_]; }
  std::size_t ownIndex() const { return own_index_; }
  const TrackTable& tracks() const { return tracks_; }
  const Track& own() const { return tracks_.at(own_index_); }
  const SeenAgents& seen() const { return seen_; }
  /// Another vehicle that VEHICLE_STATES tells of, if others are known from there at all.
  bool knowsOf(std::size_t vehicle) const {
    return vehicle != own_index_ && experiment_.planner.others != "tracks" &&
           tracks_.at(vehicle).seen();
  }
  /// Whether a track is a vehicle that is known of already: within the body of one that is tracked.
  bool isKnown(const SeenAgent& agent, core::Utime now) const;

  /// Of a vehicle that flies: seen above safety.airborne_height_m.
  bool inTheAir() const;
  bool atRestOnFloor() const;
  /// m, horizontal, from where the own vehicle was seen last.
  double awayFrom(const core::Goal& goal) const;

  /// Why nobody can tell where a vehicle is that may be near; empty: everybody near is tracked.
  std::string lostNeighbour(core::Utime now) const;
  /// m, horizontal, between bodies, to the nearest other; infinite without others.
  double closestSeparation(core::Utime now) const;

  /// The own vehicle as policies see it.
  core::EgoAgent egoAgent(core::Utime now, const core::Goal& goal) const;
  /// The others as policies see them: whoever was ever seen, larger with the age of its track,
  /// then those that perception sees.
  void collectOthers(core::Utime now, std::vector<core::OtherAgent>& others) const;

 private:
  const config::Experiment& experiment_;
  std::size_t own_index_;
  const TrackTable& tracks_;
  const SeenAgents& seen_;
};

}  // namespace roundabout::planner
