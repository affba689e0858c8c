#include "perception/tracking/tracker.h"

#include <algorithm>
#include <cmath>

#include "common/core/assignment.h"
#include "common/core/time.h"

namespace roundabout::perception {

namespace {

// 99.9 % of a chi-squared variable with two degrees of freedom.
constexpr double kGate = 13.8;
// Nobody jumps this far between two scans, however uncertain.
constexpr double kFarthest_m = 0.8;
// A track that is not yet believed takes a detection only if no other wants it.
constexpr double kTentativeCost = 4.0;
// Two people's middles are not nearer.
constexpr double kBody_m = 0.35;
// Tracks nearer than this to each other for a while are one body.
constexpr double kSame_m = 0.25;
constexpr core::Utime kSameFor = core::kMicrosPerSecond / 2;
constexpr double kConfirmed = 0.8;
constexpr double kGone = 0.1;
// Of the share of existence that is left, per scan of 25 ms that shows it or should.
constexpr double kSeenGain = 0.2;
// Displacement that furniture's noise does not reach.
constexpr double kMoved_m = 0.5;
// So long one leg errs to the same side: scans that follow each other say little new.
constexpr double kOneLegErrs_s = 0.225;
// Time constant of shapes and classes.
constexpr double kSmoothing = 0.05;
// Furniture is what has not moved for so long.
constexpr double kStaticAfter_s = 5.0;
constexpr double kPersonAfter_s = 0.5;
constexpr double kMostlyLegs = 0.7;
constexpr double kCameraSure = 0.3;
// Nobody is followed into the dark with a velocity that has become a guess.
constexpr double kVelocityMemory_s = 1.0;

}  // namespace

Tracker::Tracker(const config::Perception& settings) : settings_(settings) {}

std::vector<Eigen::Vector2d> Tracker::expectedAt(core::Utime utime) const {
  std::vector<Eigen::Vector2d> expected;
  const double step_s = now_ == 0 ? 0.0 : core::toSeconds(utime - now_);
  for (const Track& track : tracks_) {
    if (track.confirmed) {
      expected.push_back(track.filter.position() + step_s * track.filter.velocity());
    }
  }
  return expected;
}

void Tracker::update(const ScanPoints& points, std::span<const Detection> detections) {
  const double step_s = now_ == 0 ? 0.0 : core::toSeconds(points.utime - now_);
  now_ = points.utime;
  for (Track& track : tracks_) {
    track.filter.predict(step_s, settings_.acceleration_density);
  }
  const std::vector<std::size_t> detection_of = assign(detections);
  std::vector<bool> used(detections.size(), false);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (detection_of[i] != core::kUnassigned) {
      used[detection_of[i]] = true;
      see(tracks_[i], detections[detection_of[i]], step_s);
    } else {
      miss(tracks_[i], points, step_s);
    }
  }
  endDoubles(points.utime);
  std::erase_if(tracks_, [&](const Track& track) {
    const double unseen_s = core::toSeconds(points.utime - track.last_seen);
    return track.existence < kGone || unseen_s > settings_.hidden_s ||
           (!track.confirmed && unseen_s > settings_.lost_s);
  });
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (!used[i] && !somebodyNear(detections[i].position_m, points.utime)) {
      begin(detections[i], points.utime);
    }
  }
}

std::vector<std::size_t> Tracker::assign(std::span<const Detection> detections) const {
  if (tracks_.empty() || detections.empty()) {
    return std::vector<std::size_t>(tracks_.size(), core::kUnassigned);
  }
  const auto rows = static_cast<Eigen::Index>(detections.size());
  const auto columns = static_cast<Eigen::Index>(tracks_.size());
  // One column more a detection: it is nobody's.
  constexpr double kNobodys = kGate + kTentativeCost;
  constexpr double kForbidden = 1e6;
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(rows, columns + rows, kNobodys);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Detection& detection = detections[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < columns; ++j) {
      const Track& track = tracks_[static_cast<std::size_t>(j)];
      const double squared =
          track.filter.squaredDistance(detection.position_m, detection.covariance_m2);
      const bool near =
          squared < kGate && (detection.position_m - track.filter.position()).norm() < kFarthest_m;
      cost(i, j) = near ? squared + (track.confirmed ? 0.0 : kTentativeCost) : kForbidden;
    }
  }
  core::Assignment assignment = core::assignAtLeastCost(cost);
  assignment.resize(tracks_.size());
  return assignment;
}

void Tracker::see(Track& track, const Detection& detection, double step_s) {
  const double repeats = detection.legs == 1 ? std::max(1.0, kOneLegErrs_s / step_s) : 1.0;
  track.filter.correct(detection.position_m, repeats * detection.covariance_m2);
  track.last_seen = now_;
  ++track.hits;
  track.existence += kSeenGain * (1.0 - track.existence);
  track.confirmed = track.confirmed || track.existence >= kConfirmed;
  track.leg_share += kSmoothing * ((detection.legs > 0 ? 1.0 : 0.0) - track.leg_share);
  track.half_width_m += kSmoothing * (detection.half_width_m - track.half_width_m);
  track.moved = track.moved || (track.filter.position() - track.born_at_m).norm() > kMoved_m;
}

void Tracker::miss(Track& track, const ScanPoints& points, double step_s) {
  const Eigen::Vector2d ray_m = track.filter.position() - points.sensor_m;
  const std::size_t beam = points.beamAt(std::atan2(ray_m.y(), ray_m.x()));
  // Nothing can be said of what is out of view or behind somebody.
  const bool in_view = beam < points.size() && ray_m.norm() < settings_.max_range_m &&
                       (points.hit[beam] == 0 || points.range_m[beam] > ray_m.norm() - kBody_m);
  const double lost_s = in_view ? settings_.lost_s : settings_.hidden_s;
  track.existence *= std::exp(std::log(kGone) * step_s / lost_s);
  track.filter.slowDown(std::exp(-step_s / kVelocityMemory_s));
}

void Tracker::begin(const Detection& detection, core::Utime utime) {
  // What looks out from behind somebody may be a piece of a wall: it can be followed, not begun.
  if (detection.hidden && detection.legs < 2) {
    return;
  }
  tracks_.push_back({next_id_++, PersonFilter(detection.position_m, detection.covariance_m2), utime,
                     utime, detection.position_m});
  tracks_.back().half_width_m = detection.half_width_m;
  tracks_.back().leg_share = detection.legs > 0 ? 1.0 : 0.0;
}

bool Tracker::somebodyNear(const Eigen::Vector2d& position_m, core::Utime utime) const {
  return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& track) {
    return track.confirmed && track.last_seen == utime &&
           (track.filter.position() - position_m).norm() < kBody_m;
  });
}

void Tracker::endDoubles(core::Utime utime) {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    bool together = false;
    for (std::size_t j = 0; j < i && !together; ++j) {
      together = (tracks_[i].filter.position() - tracks_[j].filter.position()).norm() < kSame_m;
    }
    if (!together) {
      tracks_[i].together_since = 0;
    } else if (tracks_[i].together_since == 0) {
      tracks_[i].together_since = utime;
    }
  }
  std::erase_if(tracks_, [&](const Track& track) {
    return track.together_since != 0 && utime - track.together_since > kSameFor;
  });
}

core::AgentClass Tracker::classOf(const Track& track) const {
  if (track.vehicle) {
    return core::AgentClass::kVehicle;
  }
  const double age_s = core::toSeconds(now_ - track.born);
  if (track.moved || track.camera_person > kCameraSure ||
      (age_s > kPersonAfter_s && track.leg_share > kMostlyLegs &&
       track.camera_person > -kCameraSure)) {
    return core::AgentClass::kPedestrian;
  }
  return age_s > kStaticAfter_s ? core::AgentClass::kStatic : core::AgentClass::kUnknown;
}

std::vector<core::AgentTrack> Tracker::tracks() const {
  std::vector<core::AgentTrack> tracks;
  for (const Track& track : tracks_) {
    if (!track.confirmed) {
      continue;
    }
    core::AgentTrack& out = tracks.emplace_back();
    out.id = track.id;
    out.agent_class = classOf(track);
    out.confidence = track.existence;
    out.position_world_m = track.filter.position();
    out.velocity_world_mps = track.filter.velocity();
    out.radius_m = out.agent_class == core::AgentClass::kPedestrian
                       ? std::max(settings_.person_radius_m, track.half_width_m)
                       : std::max(settings_.least_radius_m, track.half_width_m);
    out.position_deviation_m = track.filter.positionDeviation();
    out.velocity_deviation_mps = track.filter.velocityDeviation();
    out.age_s = core::toSeconds(now_ - track.born);
    out.unseen_s = core::toSeconds(now_ - track.last_seen);
  }
  return tracks;
}

}  // namespace roundabout::perception
