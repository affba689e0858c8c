#include "planner/situation.h"

#include <algorithm>
#include <limits>

namespace roundabout::planner {

namespace {

// A vehicle that was seen longer ago may have left its place to somebody else.
constexpr double kFreshTrack_s = 0.3;
// Slower than this, a vehicle on the floor has landed (and one that drives has stopped).
constexpr double kAtRest_mps = 0.1;

}  // namespace

bool Situation::inTheAir() const {
  return own().seen() && config::flies(vehicle()) &&
         own().state().position_world_m.z() - experiment_.room.min_m.z() >
             experiment_.safety.airborne_height_m;
}

bool Situation::atRestOnFloor() const {
  return own().seen() && !inTheAir() && own().state().velocity_world_mps.norm() < kAtRest_mps;
}

double Situation::awayFrom(const core::Goal& goal) const {
  return (goal.position_world_m - own().state().position_world_m).head<2>().norm();
}

std::string Situation::lostNeighbour(core::Utime now) const {
  const config::Safety& safety = experiment_.safety;
  const Eigen::Vector2d own_m = own().positionAt(now);
  for (std::size_t i = 0; i < tracks_.size() && experiment_.planner.others != "tracks"; ++i) {
    const Track& other = tracks_.at(i);
    if (i == own_index_) {
      continue;
    }
    if (!other.seen()) {
      return experiment_.vehicles[i].name + " was never tracked";
    }
    const double distance_m = std::min((other.state().position_world_m.head<2>() - own_m).norm(),
                                       (other.positionAt(now) - own_m).norm());
    if (other.ageS(now) > safety.other_track_lost_s &&
        distance_m <= safety.other_track_hold_radius_m) {
      return experiment_.vehicles[i].name + " is near and not tracked";
    }
  }
  return {};
}

double Situation::closestSeparation(core::Utime now) const {
  double closest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tracks_.size() && own().seen(); ++i) {
    if (!knowsOf(i)) {
      continue;
    }
    const double centres_m = (tracks_.at(i).positionAt(now) - own().positionAt(now)).norm();
    closest_m = std::min(
        closest_m, centres_m - vehicle().body_radius_m - experiment_.vehicles[i].body_radius_m);
  }
  for (const SeenAgent& agent : seen_.agents()) {
    if (isKnown(agent, now)) {
      continue;
    }
    const double centres_m = (agent.position_m - own().positionAt(now)).norm();
    closest_m = std::min(closest_m, centres_m - vehicle().body_radius_m - agent.radius_m);
  }
  return closest_m;
}

bool Situation::isKnown(const SeenAgent& agent, core::Utime now) const {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (knowsOf(i) && tracks_.at(i).sinceAcceptedS(now) <= kFreshTrack_s &&
        (tracks_.at(i).positionAt(now) - agent.position_m).norm() <
            experiment_.vehicles[i].body_radius_m) {
      return true;
    }
  }
  return false;
}

core::EgoAgent Situation::egoAgent(core::Utime now, const core::Goal& goal) const {
  core::EgoAgent ego;
  ego.position_world_m = own().positionAt(now);
  ego.velocity_world_mps = own().state().velocity_world_mps.head<2>();
  ego.heading_world_rad = core::headingOf(own().state().orientation);
  ego.goal_world_m = goal.position_world_m.head<2>();
  ego.preferred_speed_mps = vehicle().preferred_speed_mps;
  ego.radius_m = vehicle().assumed_radius_m;
  return ego;
}

void Situation::collectOthers(core::Utime now, std::vector<core::OtherAgent>& others) const {
  others.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Track& track = tracks_.at(i);
    if (!knowsOf(i)) {
      continue;
    }
    const config::Vehicle& other = experiment_.vehicles[i];
    // Who is lost for good grows no more: those who are near hold.
    const double unseen_s =
        std::min(track.sinceAcceptedS(now), experiment_.safety.other_track_lost_s);
    others.push_back({track.positionAt(now), track.state().velocity_world_mps.head<2>(),
                      other.assumed_radius_m + other.top_speed_mps * unseen_s,
                      static_cast<int>(i)});
  }
  for (const SeenAgent& agent : seen_.agents()) {
    if (!isKnown(agent, now)) {
      others.push_back(
          {agent.position_m, agent.velocity_mps, agent.radius_m + agent.uncertainty_m, agent.id});
    }
  }
}

}  // namespace roundabout::planner
