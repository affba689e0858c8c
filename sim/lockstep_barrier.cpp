#include "sim/lockstep_barrier.h"

#include <algorithm>

namespace roundabout::sim {

LockstepBarrier::LockstepBarrier(std::size_t num_planners, double planner_rate_hz,
                                 double fleet_rate_hz)
    : participants_(num_planners, Participant{core::TickTimer(planner_rate_hz)}) {
  participants_.push_back({core::TickTimer(fleet_rate_hz)});
}

void LockstepBarrier::heard(std::size_t participant) { participants_[participant].present = true; }

void LockstepBarrier::answered(std::size_t participant, core::Utime frame_utime) {
  heard(participant);
  if (frame_utime == frame_utime_) {
    participants_[participant].awaited = false;
  }
}

void LockstepBarrier::onFrame(core::Utime utime) {
  frame_utime_ = utime;
  for (Participant& participant : participants_) {
    const bool due = participant.timer.due(utime);
    participant.awaited = due && participant.present;
  }
}

void LockstepBarrier::giveUp() {
  for (Participant& participant : participants_) {
    participant.present = participant.present && !participant.awaited;
    participant.awaited = false;
  }
}

bool LockstepBarrier::complete() const {
  return std::none_of(participants_.begin(), participants_.end(),
                      [](const Participant& participant) { return participant.awaited; });
}

std::vector<std::size_t> LockstepBarrier::awaited() const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    if (participants_[i].awaited) {
      result.push_back(i);
    }
  }
  return result;
}

std::vector<std::size_t> LockstepBarrier::absent() const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    if (!participants_[i].present) {
      result.push_back(i);
    }
  }
  return result;
}

}  // namespace roundabout::sim
