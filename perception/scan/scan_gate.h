#pragma once

#include <cstddef>

#include "common/core/frame_gate.h"
#include "common/core/laser_scan.h"

namespace roundabout::perception {

/// Judges sweeps before anything is made of them.
class ScanGate {
 public:
  /// nullptr: good; else why not, in a few words. The number of beams is the first sweep's; ten in
  /// a row with another one are believed.
  const char* judge(const core::LaserScan& scan);
  /// The sweep just accepted is of another epoch than those before.
  bool newEpoch() const { return new_epoch_; }
  core::Utime last() const { return times_.last(); }

 private:
  core::FrameGate times_;
  std::size_t beams_ = 0;
  std::size_t other_beams_ = 0;
  int others_in_a_row_ = 0;
  bool new_epoch_ = false;
};

}  // namespace roundabout::perception
