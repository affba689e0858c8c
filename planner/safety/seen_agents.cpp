#include "planner/safety/seen_agents.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/config/obstacles.h"
#include "common/core/frame_gate.h"
#include "common/core/polygon.h"

namespace roundabout::planner {

namespace {

// Standard deviations that a track may be off by.
constexpr double kDeviations = 1.0;
constexpr double kMostDeviations = 3.0;
// Nobody is counted on to be farther from where it was last measured.
constexpr double kMostUncertainty_m = 0.5;
// Of a person, against the velocity that was believed of it while it was not measured.
constexpr double kAcceleration_mps2 = 1.0;
// What stands with its centre nearer to a surface than this is a piece of it.
constexpr double kAtSurface_m = 0.1;

}  // namespace

SeenAgents::SeenAgents(const config::Experiment& experiment, std::size_t own_index)
    : used_(experiment.planner.others != "states"),
      hold_s_(experiment.safety.tracks_hold_s),
      standing_mps_(experiment.planner.standing_speed_mps),
      walls_are_seen_(experiment.vehicles[own_index].lidar &&
                      experiment.vehicles[own_index].lidar->sees_room_walls),
      room_(experiment.room.min_m.head<2>(), experiment.room.max_m.head<2>()),
      obstacles_(config::outlinesOf(experiment.obstacles)) {}

const char* SeenAgents::offer(const core::AgentTracks& tracks, core::Utime newest_frame) {
  if (tracks.utime < 0 || (newest_frame > 0 && tracks.utime > newest_frame + core::kFarAhead)) {
    return "its time stamp is corrupt";
  }
  if (any_ && tracks.utime < current_.utime) {
    return "older than the tracks before";
  }
  if (waiting_.size() == kCapacity) {
    waiting_.erase(waiting_.begin());
  }
  waiting_.push_back(tracks);
  return nullptr;
}

void SeenAgents::apply(core::Utime now) {
  now_ = now;
  for (core::AgentTracks& tracks : waiting_) {
    if (tracks.utime >= now) {
      continue;
    }
    if (tracks.health == core::PerceptionHealth::kBlind) {
      blind_reason_ = tracks.reason;
    } else if (!any_ || tracks.utime >= current_.utime) {
      current_ = std::move(tracks);
      any_ = true;
      blind_reason_.clear();
    }
  }
  std::erase_if(waiting_, [now](const core::AgentTracks& each) { return each.utime < now; });
  agents_.clear();
  if (fresh()) {
    for (const core::AgentTrack& track : current_.tracks) {
      if (canBeSomebody(track)) {
        agents_.push_back(seen(track, ageS()));
      }
    }
  }
}

SeenAgent SeenAgents::seen(const core::AgentTrack& track, double age_s) const {
  SeenAgent agent;
  agent.id = SeenAgent::kFirstId + track.id;
  agent.stands = track.velocity_world_mps.norm() < standing_mps_ ||
                 track.agent_class == core::AgentClass::kStatic;
  agent.measured_m = track.position_world_m;
  agent.velocity_mps =
      agent.stands ? Eigen::Vector2d(Eigen::Vector2d::Zero()) : track.velocity_world_mps;
  agent.position_m = agent.measured_m + age_s * agent.velocity_mps;
  agent.radius_m = track.radius_m;
  agent.age_s = age_s;
  const double unseen_s = age_s + track.unseen_s;
  agent.uncertainty_m =
      std::min(kMostUncertainty_m,
               kDeviations * (track.position_deviation_m + track.velocity_deviation_mps * age_s) +
                   0.5 * kAcceleration_mps2 * unseen_s * unseen_s);
  return agent;
}

bool SeenAgents::canBeSomebody(const core::AgentTrack& track) const {
  const double surface_m = fromSurfaceM(track.position_world_m);
  if (surface_m < -kMostDeviations * track.position_deviation_m) {
    return false;
  }
  return surface_m > kAtSurface_m || track.agent_class == core::AgentClass::kPedestrian ||
         track.velocity_world_mps.norm() >= standing_mps_;
}

/// Negative inside.
double SeenAgents::fromSurfaceM(const Eigen::Vector2d& place_m) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  if (walls_are_seen_) {
    nearest_m = std::min((place_m - room_.min()).minCoeff(), (room_.max() - place_m).minCoeff());
  }
  for (const core::Polygon& obstacle : obstacles_) {
    nearest_m = std::min(nearest_m, core::distanceTo(obstacle, place_m));
  }
  return nearest_m;
}

bool SeenAgents::fresh() const { return any_ && ageS() <= hold_s_; }

double SeenAgents::ageS() const {
  return any_ ? core::toSeconds(now_ - current_.utime) : std::numeric_limits<double>::infinity();
}

void SeenAgents::clear() {
  waiting_.clear();
  current_ = {};
  any_ = false;
  blind_reason_.clear();
  agents_.clear();
}

}  // namespace roundabout::planner
