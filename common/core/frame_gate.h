#pragma once

#include "common/core/time.h"

namespace roundabout::core {

/// A time stamp that far ahead of the vehicle states is corrupt.
constexpr Utime kFarAhead = 10 * kMicrosPerSecond;

/// Refuses frames whose time stamp is not newer than the last, or far ahead (until ten in a row
/// agree: then the source was away for that long).
class FrameGate {
 public:
  bool accept(Utime utime);
  Utime last() const { return last_; }

 private:
  Utime last_ = 0;
  Utime ahead_ = 0;
  int ahead_run_ = 0;
};

}  // namespace roundabout::core
