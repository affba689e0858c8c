#include "common/core/frame_gate.h"

namespace roundabout::core {

bool FrameGate::accept(Utime utime) {
  constexpr int kAgreeing = 10;
  if (utime <= last_) {
    return false;
  }
  if (last_ > 0 && utime - last_ > kFarAhead) {
    const bool agrees = ahead_run_ > 0 && utime > ahead_ && utime - ahead_ <= kFarAhead;
    ahead_run_ = agrees ? ahead_run_ + 1 : 1;
    ahead_ = utime;
    if (ahead_run_ < kAgreeing) {
      return false;
    }
  }
  last_ = utime;
  ahead_run_ = 0;
  return true;
}

}  // namespace roundabout::core
