#include "planner/safety/tracks.h"

#include <algorithm>
#include <numeric>

namespace roundabout::planner {

namespace {

// Times the top speed: differentiated positions are noisy, but not that noisy.
constexpr double kFastestMeasured = 2.0;

}  // namespace

Track::Track(double top_speed_mps, const config::Safety& safety)
    : top_speed_mps_(top_speed_mps),
      jump_margin_m_(safety.jump_margin_m),
      longest_extrapolation_s_(safety.other_track_lost_s),
      max_rejects_(safety.max_rejects_in_a_row) {}

double Track::allowedJumpM(core::Utime from, core::Utime to) const {
  return top_speed_mps_ * core::toSeconds(to - from) + jump_margin_m_;
}

bool Track::update(const core::VehicleState& measured, core::Utime utime) {
  if (measured.velocity_world_mps.norm() > kFastestMeasured * top_speed_mps_) {
    reject();
    return false;
  }
  const auto within_reach = [&](const core::VehicleState& earlier, core::Utime earlier_utime) {
    return (measured.position_world_m - earlier.position_world_m).norm() <=
           allowedJumpM(earlier_utime, utime);
  };
  bool accepted = !seen() || (!lost() && within_reach(state_, last_accepted_));
  if (!accepted) {
    const bool agrees = candidate_run_ > 0 && within_reach(candidate_, candidate_utime_);
    candidate_run_ = agrees ? candidate_run_ + 1 : 1;
    candidate_ = measured;
    candidate_utime_ = utime;
    accepted = lost() && candidate_run_ > max_rejects_;
  }
  if (!accepted) {
    reject();
    return false;
  }
  state_ = measured;
  last_accepted_ = utime;
  rejects_in_a_row_ = 0;
  candidate_run_ = 0;
  return true;
}

void Track::reject() {
  ++rejects_in_a_row_;
  ++rejected_;
}

double Track::ageS(core::Utime now) const {
  return seen() && !lost() ? sinceAcceptedS(now) : std::numeric_limits<double>::infinity();
}

Eigen::Vector2d Track::positionAt(core::Utime now) const {
  return state_.position_world_m.head<2>() +
         state_.velocity_world_mps.head<2>() *
             std::min(sinceAcceptedS(now), longest_extrapolation_s_);
}

TrackTable::TrackTable(const config::Experiment& experiment)
    : jump_margin_m_(experiment.safety.jump_margin_m) {
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    index_of_[vehicle.name] = tracks_.size();
    tracks_.emplace_back(vehicle.top_speed_mps, experiment.safety);
  }
}

bool TrackTable::exchanged(std::size_t index, const core::VehicleState& measured,
                           core::Utime utime) const {
  const Track& own = tracks_[index];
  const Eigen::Vector2d position = measured.position_world_m.head<2>();
  if (!own.seen() || (position - own.positionAt(utime)).norm() <= jump_margin_m_) {
    return false;
  }
  for (std::size_t other = 0; other < tracks_.size(); ++other) {
    if (other != index && tracks_[other].seen() &&
        (position - tracks_[other].positionAt(utime)).norm() <= jump_margin_m_) {
      return true;
    }
  }
  return false;
}

int TrackTable::update(const core::StatesFrame& frame) {
  int unknown = 0;
  // Judge all bodies against the same past, so that the order within the frame does not matter.
  std::vector<bool> swapped(frame.vehicles.size(), false);
  for (std::size_t i = 0; i < frame.vehicles.size(); ++i) {
    const auto found = index_of_.find(frame.vehicles[i].name);
    swapped[i] = found != index_of_.end() && frame.vehicles[i].tracked &&
                 exchanged(found->second, frame.vehicles[i], frame.utime);
  }
  for (std::size_t i = 0; i < frame.vehicles.size(); ++i) {
    const core::VehicleState& measured = frame.vehicles[i];
    const auto found = index_of_.find(measured.name);
    if (found == index_of_.end()) {
      ++unknown;
    } else if (swapped[i]) {
      tracks_[found->second].reject();
    } else if (measured.tracked) {
      tracks_[found->second].update(measured, frame.utime);
    }
  }
  return unknown;
}

int TrackTable::rejectedMeasurements() const {
  return std::accumulate(tracks_.begin(), tracks_.end(), 0,
                         [](int sum, const Track& track) { return sum + track.rejected(); });
}

}  // namespace roundabout::planner
