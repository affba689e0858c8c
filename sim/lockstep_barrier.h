#pragma once

#include <cstddef>
#include <vector>

#include "common/core/tick_timer.h"
#include "common/core/time.h"

namespace roundabout::sim {

/// Knows who has to answer which frame before the next one may go out. Participants are the
/// planners, numbered as the vehicles, and the fleet, which comes last.
///
///   absent --heard--> present --a frame that is a tick of its--> awaited --answer--> present
///   awaited --giveUp--> absent; who is heard again takes part from the next frame on.
class LockstepBarrier {
 public:
  LockstepBarrier(std::size_t num_planners, double planner_rate_hz, double fleet_rate_hz);

  std::size_t fleet() const { return participants_.size() - 1; }

  /// Anything came from the participant.
  void heard(std::size_t participant);
  /// The participant answered the frame of that utime; this too is being heard.
  void answered(std::size_t participant, core::Utime frame_utime);

  /// A frame went out: every present participant for whom it is a tick is awaited. Precondition:
  /// complete().
  void onFrame(core::Utime utime);
  /// Whoever is still awaited is absent from now on.
  void giveUp();

  bool complete() const;
  std::vector<std::size_t> awaited() const;
  std::vector<std::size_t> absent() const;

 private:
  struct Participant {
    core::TickTimer timer;
    bool present = false;
    bool awaited = false;
  };

  std::vector<Participant> participants_;
  core::Utime frame_utime_ = 0;
};

}  // namespace roundabout::sim
