#pragma once

#include "common/core/time.h"

namespace roundabout::core {

/// A goal's or status's time stamp that far ahead of the vehicle states is corrupt.
constexpr Utime kFarAhead = 10 * kMicrosPerSecond;

enum class FrameVerdict {
  kRefused,
  kAccepted,
  kNewEpoch  ///< accepted, and nothing from before holds any more
};

/// Judges frames by their time stamps. The next frame is up to 0.2 s newer than the last. A stamp
/// elsewhere may be corrupt and is refused, until ten in a row agree with each other: if they lie
/// ahead, the source was away for that long; if they lie behind, the source was started anew or its
/// clock was set back, which is a new epoch. Sources slower than 5 Hz do not pass.
class FrameGate {
 public:
  FrameVerdict judge(Utime utime);

  /// Stamp of the last accepted frame; 0: none.
  Utime last() const { return last_; }

 private:
  Utime last_ = 0;
  Utime candidate_ = 0;  // the latest stamp that was elsewhere
  int agreeing_ = 0;
};

}  // namespace roundabout::core
