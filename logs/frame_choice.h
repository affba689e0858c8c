#pragma once

#include <cstddef>
#include <vector>

#include "common/core/frame_gate.h"

namespace roundabout::logs {

/// The frames of one flight among the events of a log.
struct FrameChoice {
  std::vector<std::size_t> events;  ///< their indices; utime strictly growing
  std::size_t begin = 0;            ///< events [begin, end) were logged while it lasted
  std::size_t end = 0;
};

/// Tells frames with corrupt time stamps, and the frames of several flights in one log, from each
/// other, as those who fly do (core::FrameGate). But a reader can look back: the frames that made
/// the gate believe a jump of the time count too.
class FrameChooser {
 public:
  /// Every frame, in the order of the log.
  void see(std::size_t event, core::Utime utime);

  /// The flight with most frames.
  FrameChoice longest(std::size_t num_events) const;

 private:
  struct Frame {
    std::size_t event;
    core::Utime utime;
  };

  void admit(const Frame& frame);

  core::FrameGate gate_;
  std::vector<std::vector<Frame>> flights_;
  std::vector<Frame> refused_;  // since the last that was not
};

}  // namespace roundabout::logs
