#include "mocap_bridge/estimation/body_tracker.h"

#include <algorithm>
#include <cmath>

#include "common/core/rotation.h"

namespace roundabout::mocap_bridge {

namespace {

constexpr double kUnitTolerance = 0.01;
constexpr int kFrozenFrames = 3;
// A measurement is expected within so many standard deviations and this much beside.
constexpr double kGate = 6.0;
constexpr double kPlaceMargin_m = 0.03;
constexpr double kAngleMargin_rad = 0.3;
// A turn by more than this in no time is a flip, not an outlier.
constexpr double kFlip_rad = 1.0;
constexpr int kEnough = 3;
constexpr core::Utime kSlowestInterval = core::kMicrosPerSecond / 4;
constexpr core::Utime kBelieveJumpAfter = core::kMicrosPerSecond;
constexpr core::Utime kRememberPlace = 2 * core::kMicrosPerSecond;
// Longer ago, nothing is known of where it is now.
constexpr core::Utime kForget = 10 * core::kMicrosPerSecond;

double angleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return core::toRotationVector(a.conjugate() * b).norm();
}

// Faults of which time does not cure.
bool isForGood(Verdict fault) { return fault == Verdict::kFlip || fault == Verdict::kSwap; }

}  // namespace

const char* nameOf(Verdict verdict) {
  constexpr std::array<const char*, kVerdicts> kNames = {
      "accepted", "absent", "not finite", "not a rotation", "bad fit",
      "frozen",   "jump",   "flip",       "swap",           "acquiring"};
  return kNames[static_cast<std::size_t>(verdict)];
}

BodyTracker::BodyTracker(const TrackerSettings& settings) : settings_(settings) {}

BodyTracker::Track BodyTracker::Track::predicted(core::Utime utime) const {
  Track later = *this;
  const double seconds = core::toSeconds(utime - last);
  later.position.predict(seconds);
  later.attitude.predict(seconds);
  later.last = utime;
  return later;
}

void BodyTracker::Track::take(core::Utime utime, const MeasuredPose& pose) {
  position.update(pose.position_m);
  attitude.update(pose.orientation);
  last = utime;
  ++measurements;
}

BodyTracker::Track BodyTracker::begin(core::Utime utime, const MeasuredPose& pose) const {
  return {PositionFilter(settings_.position, pose.position_m, settings_.max_speed_mps,
                         settings_.max_acceleration_mps2),
          AttitudeFilter(settings_.attitude, pose.orientation, settings_.max_turn_rate_radps / 3.0),
          utime, utime, 1};
}

BodyTracker::Fit BodyTracker::fitOf(const Track& expected, const MeasuredPose& pose) {
  const double distance_m = (pose.position_m - expected.position.position()).norm();
  const double angle_rad = angleBetween(expected.attitude.orientation(), pose.orientation);
  const double place_deviation = expected.position.innovationDeviation();
  const double angle_deviation = expected.attitude.innovationDeviation();
  return {distance_m <= kGate * place_deviation + kPlaceMargin_m,
          angle_rad <= kGate * angle_deviation + kAngleMargin_rad};
}

Verdict BodyTracker::check(const MeasuredPose& pose) {
  if (!pose.tracked) {
    return Verdict::kAbsent;
  }
  if (!pose.position_m.allFinite() || !pose.orientation.coeffs().allFinite()) {
    return Verdict::kNotFinite;
  }
  if (std::abs(pose.orientation.norm() - 1.0) > kUnitTolerance) {
    return Verdict::kNotRotation;
  }
  if (pose.residual_m > settings_.max_residual_m) {
    return Verdict::kBadFit;
  }
  const bool same = pose.position_m == last_pose_.position_m &&
                    pose.orientation.coeffs() == last_pose_.orientation.coeffs();
  repeats_ = same ? std::min(repeats_ + 1, kFrozenFrames) : 0;
  last_pose_ = pose;
  return repeats_ + 1 >= kFrozenFrames ? Verdict::kFrozen : Verdict::kAccepted;
}

Verdict BodyTracker::note(core::Utime utime, Verdict verdict) {
  ++counts_[static_cast<std::size_t>(verdict)];
  in_last_frame_ = verdict == Verdict::kAccepted;
  if (last_frame_ != 0 && utime > last_frame_) {
    intervals_ = {intervals_[1], utime - last_frame_};
  }
  last_frame_ = utime;
  return verdict;
}

Verdict BodyTracker::miss(core::Utime utime) { return note(utime, Verdict::kAbsent); }

Verdict BodyTracker::update(core::Utime utime, const MeasuredPose& measured, bool others_place) {
  return note(utime, judge(utime, measured, others_place));
}

bool BodyTracker::goesOn(const Track& track, core::Utime utime, core::Utime longest_gap) const {
  const core::Utime gap = utime - track.last;
  const core::Utime interval = std::min(intervals_[0], intervals_[1]);
  const core::Utime next_frame = std::min(kSlowestInterval, interval + interval / 2);
  return gap <= longest_gap || (track.last == last_frame_ && gap <= next_frame);
}

Verdict BodyTracker::judge(core::Utime utime, const MeasuredPose& measured, bool others_place) {
  const Verdict verdict = check(measured);
  if (verdict != Verdict::kAccepted) {
    return verdict;
  }
  MeasuredPose pose = measured;
  pose.orientation.normalize();
  if (believed_ && utime <= believed_->last) {
    return Verdict::kAbsent;  // nothing can be learned from the past
  }
  if (believed_ && goesOn(*believed_, utime, settings_.coast_us)) {
    Track expected = believed_->predicted(utime);
    const Fit fit = fitOf(expected, pose);
    if (fit.place && fit.angle) {
      expected.take(utime, pose);
      believed_ = expected;
      candidate_.reset();
      rejected_.reset();
      return Verdict::kAccepted;
    }
  }
  return followCandidate(utime, pose, others_place);
}

Verdict BodyTracker::followCandidate(core::Utime utime, const MeasuredPose& pose,
                                     bool others_place) {
  // Two frames may be missing within a candidate.
  if (!candidate_ || !goesOn(*candidate_, utime, settings_.reacquire_us)) {
    return beginCandidate(utime, pose, others_place);
  }
  Track expected = candidate_->predicted(utime);
  const Fit fit = fitOf(expected, pose);
  if (!fit.place || !fit.angle) {
    return beginCandidate(utime, pose, others_place);
  }
  expected.take(utime, pose);
  candidate_ = expected;
  const bool never = isForGood(candidate_fault_);
  const core::Utime needed =
      candidate_fault_ == Verdict::kJump ? kBelieveJumpAfter : settings_.reacquire_us;
  if (never || utime - candidate_->begin < needed || candidate_->measurements < kEnough) {
    return candidate_fault_;
  }
  believed_ = candidate_;
  candidate_.reset();
  rejected_.reset();
  return Verdict::kAccepted;
}

Verdict BodyTracker::beginCandidate(core::Utime utime, const MeasuredPose& pose,
                                    bool others_place) {
  if (candidate_ && isForGood(candidate_fault_)) {
    rejected_ = {*candidate_, candidate_fault_, candidate_turn_};
  }
  candidate_ = begin(utime, pose);
  candidate_fault_ = Verdict::kAcquiring;
  if (continuesRejected(utime, pose)) {
    candidate_fault_ = rejected_->fault;
    candidate_turn_ = rejected_->turn;
  } else if (others_place) {
    candidate_fault_ = Verdict::kSwap;
  } else if (believed_ && utime - believed_->last <= kForget && !reachable(utime, pose)) {
    const Track expected = believed_->predicted(utime);
    const double angle_rad = angleBetween(believed_->attitude.orientation(), pose.orientation);
    candidate_fault_ =
        fitOf(expected, pose).place && angle_rad > kFlip_rad ? Verdict::kFlip : Verdict::kJump;
    candidate_turn_ = expected.attitude.orientation().conjugate() * pose.orientation;
  }
  return candidate_fault_;
}

bool BodyTracker::reachable(core::Utime utime, const MeasuredPose& pose) const {
  const double passed_s = core::toSeconds(utime - believed_->last);
  const double distance_m = (pose.position_m - believed_->position.position()).norm();
  const double angle_rad = angleBetween(believed_->attitude.orientation(), pose.orientation);
  return distance_m <= settings_.max_speed_mps * passed_s + kPlaceMargin_m &&
         angle_rad <= settings_.max_turn_rate_radps * passed_s + kAngleMargin_rad;
}

bool BodyTracker::continuesRejected(core::Utime utime, const MeasuredPose& pose) const {
  if (!rejected_ || !believed_ || utime - believed_->last > kForget) {
    return false;
  }
  const Track seen =
      rejected_->track.predicted(std::min(utime, rejected_->track.last + settings_.coast_us));
  if (rejected_->fault == Verdict::kFlip) {
    const Eigen::Quaterniond flipped = seen.attitude.orientation();
    const double angle_rad = angleBetween(flipped * rejected_->turn.conjugate(), pose.orientation);
    return angle_rad > kFlip_rad || angle_rad > angleBetween(flipped, pose.orientation);
  }
  const double reach_m =
      settings_.max_speed_mps * core::toSeconds(utime - rejected_->track.last) + kPlaceMargin_m;
  const double distance_m = (pose.position_m - seen.position.position()).norm();
  return distance_m <= reach_m &&
         distance_m < (pose.position_m - believed_->position.position()).norm();
}

void BodyTracker::stateAt(core::Utime utime, core::VehicleState& state) const {
  state.tracked = false;
  state.predicted = false;
  if (!believed_) {
    return;
  }
  state.last_seen = believed_->last;
  const core::Utime age = utime - believed_->last;
  const bool fresh = age <= settings_.coast_us;
  state.tracked = in_last_frame_ && fresh;
  state.predicted = !in_last_frame_ && fresh;
  const Track there =
      believed_->predicted(believed_->last + std::clamp<core::Utime>(age, 0, settings_.coast_us));
  state.position_world_m = there.position.position();
  state.velocity_world_mps = there.position.velocity();
  state.orientation = there.attitude.orientation();
  state.angular_velocity_body_radps = there.attitude.angularVelocityBody();
}

std::optional<Eigen::Vector3d> BodyTracker::placeAt(core::Utime utime) const {
  if (!believed_ || utime - believed_->last > kRememberPlace) {
    return std::nullopt;
  }
  const double seconds =
      core::toSeconds(std::clamp<core::Utime>(utime - believed_->last, 0, settings_.coast_us));
  return believed_->position.position() + seconds * believed_->position.velocity();
}

std::optional<Verdict> BodyTracker::stuckWith(core::Utime utime) const {
  const bool stuck = candidate_ && isForGood(candidate_fault_) &&
                     utime - candidate_->begin > core::kMicrosPerSecond &&
                     goesOn(*candidate_, utime, settings_.reacquire_us);
  return stuck ? std::optional(candidate_fault_) : std::nullopt;
}

}  // namespace roundabout::mocap_bridge
