#pragma once

#include <string>

#include "planner/goal_queue.h"
#include "planner/safety/order_latch.h"
#include "planner/safety/room_guard.h"
#include "planner/situation.h"
#include "planner/status.h"

namespace roundabout::planner {

/// Why the vehicle does not see what it drives by: scans, tracks; empty: it sees enough.
struct Sight {
  std::string missing;
};

/// Decides on every tick whether the vehicle flies, and if not, which safe thing it does: the latch
/// first, then landing, the own track, lost neighbours, and only then the goal.
class ModeMachine {
 public:
  OrderLatch& latch() { return latch_; }
  const OrderLatch& latch() const { return latch_; }
  bool killed() const { return latch_.state() == Latch::kKill; }

  /// `period_s`: to the next tick.
  Verdict decide(core::Utime now, double period_s, const Situation& situation,
                 const GoalQueue& goals, const RoomGuard& room, const Sight& sight);

  /// No states for `silence_s` of wall clock.
  Verdict decideOnSilence(double silence_s, const config::Safety& safety, const GoalQueue& goals);

  /// Two frames were `gap_s` of data time apart.
  void noteGap(double gap_s, const config::Safety& safety);
  void noteNewGoal() { landing_done_ = false; }
  void noteGoalFromThePast() {
    latch_.fault(Latch::kHold, "restarted during a flight; needs a resume");
  }
  /// The states' time went back.
  void beginAnew() { placed_ = false; }

 private:
  void latchFaults(core::Utime now, double period_s, const Situation& situation,
                   const RoomGuard& room);
  Verdict obeyGoal(const Situation& situation, const GoalQueue& goals, const Sight& sight) const;
  Verdict judge(core::Utime now, const Situation& situation, const GoalQueue& goals,
                const Sight& sight);
  Verdict land(const std::string& reason, const Situation& situation);
  void noteMotors(Mode mode, const Situation& situation);

  OrderLatch latch_;
  bool placed_ = false;     // the own vehicle was seen
  bool motors_on_ = false;  // as far as anybody can tell from here
  bool landing_done_ = false;
};

}  // namespace roundabout::planner
