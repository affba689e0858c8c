#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/core/time.h"
#include "common/core/vehicle_state.h"
#include "mocap_bridge/estimation/attitude_filter.h"
#include "mocap_bridge/estimation/position_filter.h"

namespace roundabout::mocap_bridge {

/// What is believed of one vehicle's movement and of its measurements.
struct TrackerSettings {
  PositionFilter::Noise position;
  AttitudeFilter::Noise attitude;
  double max_speed_mps = 2.0;
  double max_acceleration_mps2 = 10.0;
  double max_turn_rate_radps = 12.0;
  double max_residual_m = 0.005;
  core::Utime coast_us = 100'000;
  core::Utime reacquire_us = 50'000;
};

/// A vehicle's measured pose in the world frame.
struct MeasuredPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  bool tracked = false;     ///< what the system says
  double residual_m = 0.0;  ///< NaN: not said
};

/// What became of a measurement.
enum class Verdict : std::uint8_t {
  kAccepted,
  kAbsent,       ///< not in the frame, or the system says that it does not see the body
  kNotFinite,    ///< a number is none
  kNotRotation,  ///< the quaternion's norm is not within 1 % of one
  kBadFit,       ///< residual above the limit
  kFrozen,       ///< the same to the last bit for three frames
  kJump,         ///< where the body cannot be
  kFlip,         ///< turned as it cannot have turned, at the right place
  kSwap,         ///< where another vehicle is believed to be
  kAcquiring     ///< plausible, but not for long enough yet
};
inline constexpr std::size_t kVerdicts = 10;
const char* nameOf(Verdict verdict);

/// One vehicle's poses to its state. Never throws, allocates nothing.
///
/// Gaps are counted in seconds, but for cameras so slow that one frame to the next is longer: by
/// the shorter of the last two intervals, a track of the last frame goes on (from 4 Hz). Frames
/// that the network keeps back do not make a camera slow.
///
/// A measurement that the filters expect is taken. Any other begins a candidate: a track of its
/// own, which replaces the believed one once it has lasted for reacquire_us, if its first pose
/// could be reached from the believed one in the time since then. A candidate that began with a
/// jump counts only after a second, and one that began on another vehicle's place or with a flip
/// never. One that begins where such a candidate ended, after a gap or an outlier, is its
/// continuation: for as long as a flipped one is not seen the right way round again, an exchanged
/// one not away from where it was, and the believed track is not older than ten seconds.
class BodyTracker {
 public:
  explicit BodyTracker(const TrackerSettings& settings);

  /// `others_place` says that the pose is where another vehicle is believed to be.
  Verdict update(core::Utime utime, const MeasuredPose& pose, bool others_place);
  /// The body is not in the frame.
  Verdict miss(core::Utime utime);

  /// The state at a time not before the last measurement that was taken. `tracked` if that was in
  /// the last frame, `predicted` if it was not and coast_us are not over. Else the state at the end
  /// of coasting. The name is left alone.
  void stateAt(core::Utime utime, core::VehicleState& state) const;

  /// Where it is believed to be, until a while after it was lost.
  std::optional<Eigen::Vector3d> placeAt(core::Utime utime) const;
  /// Flip or swap, where one has lasted for a second: worth a word to the operator.
  std::optional<Verdict> stuckWith(core::Utime utime) const;
  std::int64_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }

 private:
  static constexpr core::Utime kUnknown = core::kMicrosPerSecond;

  struct Track {
    PositionFilter position;
    AttitudeFilter attitude;
    core::Utime begin = 0;
    core::Utime last = 0;
    int measurements = 0;

    Track predicted(core::Utime utime) const;
    void take(core::Utime utime, const MeasuredPose& pose);
  };
  struct Rejected {
    Track track;
    Verdict fault;            // flip or swap
    Eigen::Quaterniond turn;  // from what was believed to what was seen, in body axes
  };
  struct Fit {
    bool place = false;
    bool angle = false;
  };

  Verdict check(const MeasuredPose& pose);
  Track begin(core::Utime utime, const MeasuredPose& pose) const;
  static Fit fitOf(const Track& expected, const MeasuredPose& pose);
  Verdict beginCandidate(core::Utime utime, const MeasuredPose& pose, bool others_place);
  Verdict followCandidate(core::Utime utime, const MeasuredPose& pose, bool others_place);
  bool reachable(core::Utime utime, const MeasuredPose& pose) const;
  bool continuesRejected(core::Utime utime, const MeasuredPose& pose) const;
  bool goesOn(const Track& track, core::Utime utime, core::Utime longest_gap) const;
  Verdict judge(core::Utime utime, const MeasuredPose& measured, bool others_place);
  Verdict note(core::Utime utime, Verdict verdict);

  TrackerSettings settings_;
  std::optional<Track> believed_;
  std::optional<Track> candidate_;
  Verdict candidate_fault_ = Verdict::kAcquiring;  // how it began
  Eigen::Quaterniond candidate_turn_ = Eigen::Quaterniond::Identity();
  std::optional<Rejected> rejected_;  // the last candidate with a flip or swap
  MeasuredPose last_pose_;
  int repeats_ = 0;
  bool in_last_frame_ = false;
  core::Utime last_frame_ = 0;
  std::array<core::Utime, 2> intervals_{kUnknown, kUnknown};  // between the last three frames
  std::array<std::int64_t, kVerdicts> counts_{};
};

}  // namespace roundabout::mocap_bridge
