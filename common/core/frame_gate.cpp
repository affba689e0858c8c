#include "common/core/frame_gate.h"

namespace roundabout::core {

namespace {

constexpr Utime kLongestStep = 200'000;
constexpr int kAgreeingStamps = 10;

bool follows(Utime utime, Utime earlier) {
  return utime > earlier && utime - earlier <= kLongestStep;
}

}  // namespace

FrameVerdict FrameGate::judge(Utime utime) {
  if (utime <= 0) {
    return FrameVerdict::kRefused;
  }
  if (last_ == 0 || follows(utime, last_)) {
    last_ = utime;
    agreeing_ = 0;
    return FrameVerdict::kAccepted;
  }
  const bool late = utime == last_ || follows(last_, utime);
  if (late) {
    return FrameVerdict::kRefused;
  }
  agreeing_ = agreeing_ > 0 && follows(utime, candidate_) ? agreeing_ + 1 : 1;
  candidate_ = utime;
  if (agreeing_ < kAgreeingStamps) {
    return FrameVerdict::kRefused;
  }
  const bool behind = utime < last_;
  last_ = utime;
  agreeing_ = 0;
  return behind ? FrameVerdict::kNewEpoch : FrameVerdict::kAccepted;
}

}  // namespace roundabout::core
