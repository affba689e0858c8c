#include "planner/mode_machine.h"

#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace roundabout::planner {

namespace {

// Near enough to the height of flight to count as taken off.
constexpr double kHeightReached_m = 0.15;

std::string noStatesReason(const config::Safety& safety) {
  return fmt::format("no vehicle states for {:.0f} ms", 1e3 * safety.states_land_s);
}

}  // namespace

void ModeMachine::noteGap(double gap_s, const config::Safety& safety) {
  if (motors_on_ && gap_s >= safety.states_land_s) {
    latch_.fault(Latch::kLand, noStatesReason(safety));
  }
}

Verdict ModeMachine::decide(core::Utime now, double period_s, const Situation& situation,
                            const GoalQueue& goals, const RoomGuard& room, const Sight& sight) {
  latchFaults(now, period_s, situation, room);
  const Verdict verdict = judge(now, situation, goals, sight);
  noteMotors(verdict.mode, situation);
  return verdict;
}

void ModeMachine::latchFaults(core::Utime now, double period_s, const Situation& situation,
                              const RoomGuard& room) {
  const config::Safety& safety = situation.experiment().safety;
  const Track& own = situation.own();
  if (!own.seen()) {
    return;
  }
  if (!placed_ && situation.inTheAir()) {
    latch_.fault(Latch::kHold, "restarted in the air; needs a resume");
  }
  placed_ = true;
  // The next tick is one period away: land now if the limit would pass before it.
  const double unseen_s = own.sinceAcceptedS(now);
  if (motors_on_ && unseen_s + period_s > safety.own_track_land_s) {
    latch_.fault(Latch::kLand, fmt::format("not tracked for {:.0f} ms", 1e3 * unseen_s));
  }
  if (situation.inTheAir() && room.mustLand(own.state().position_world_m)) {
    latch_.fault(Latch::kLand,
                 fmt::format("more than {:.1f} m outside the room", safety.room_land_margin_m));
  }
}

Verdict ModeMachine::judge(core::Utime now, const Situation& situation, const GoalQueue& goals,
                           const Sight& sight) {
  switch (latch_.state()) {
    case Latch::kKill:
      return {Mode::kKilled, latch_.reason()};
    case Latch::kLand:
      return land(latch_.reason(), situation);
    case Latch::kHold:
      return {Mode::kHolding, latch_.reason()};
    case Latch::kNone:
      break;
  }
  // Landing is the safest there is, also for a vehicle that cannot be seen.
  if (goals.landing()) {
    return land("", situation);
  }
  const Track& own = situation.own();
  if (!own.seen()) {
    return {Mode::kWaiting, "own vehicle was never tracked"};
  }
  if (own.lost()) {
    return {Mode::kHolding, "own track is lost"};
  }
  if (own.ageS(now) >= situation.experiment().safety.own_track_hold_s) {
    return {Mode::kHolding, "own vehicle is not tracked"};
  }
  if (const std::string lost = situation.lostNeighbour(now); !lost.empty()) {
    return {motors_on_ ? Mode::kHolding : Mode::kOnFloor, lost};
  }
  return obeyGoal(situation, goals, sight);
}

Verdict ModeMachine::land(const std::string& reason, const Situation& situation) {
  landing_done_ = !situation.inTheAir() && (landing_done_ || situation.atRestOnFloor());
  return {landing_done_ ? Mode::kLanded : Mode::kLanding, reason};
}

Verdict ModeMachine::obeyGoal(const Situation& situation, const GoalQueue& goals,
                              const Sight& sight) const {
  const auto& goal = goals.current();
  const bool flies = config::flies(situation.vehicle());
  if (!goal) {
    return situation.inTheAir()      ? Verdict{Mode::kHolding, "in the air without a goal"}
           : goals.refusal().empty() ? Verdict{Mode::kOnFloor, "no goal yet"}
                                     : Verdict{Mode::kOnFloor, goals.refusal()};
  }
  if (goal->phase == core::GoalPhase::kTakeOff) {
    const double away_m = situation.awayFrom(*goal);
    if (flies && !situation.inTheAir() && away_m > kTakeOffReachM) {
      return {Mode::kOnFloor, fmt::format("the take-off goal is {:.1f} m away", away_m)};
    }
    const double below_m =
        goal->position_world_m.z() - situation.own().state().position_world_m.z();
    const bool reached = !flies || std::abs(below_m) < kHeightReached_m;
    return {reached ? Mode::kAtGoal : Mode::kTakingOff, ""};
  }
  if (flies && !situation.inTheAir()) {
    return {Mode::kOnFloor, goals.refusal().empty() ? "on the floor: a take-off must come before go"
                                                    : goals.refusal()};
  }
  if (!sight.missing.empty()) {
    return {Mode::kHolding, sight.missing};
  }
  return {Mode::kFlying, goals.refusal()};
}

void ModeMachine::noteMotors(Mode mode, const Situation& situation) {
  if (situation.inTheAir() || mode == Mode::kTakingOff) {
    motors_on_ = config::flies(situation.vehicle());
  } else if (mode == Mode::kOnFloor || mode == Mode::kLanded || mode == Mode::kKilled) {
    motors_on_ = false;
  }
}

Verdict ModeMachine::decideOnSilence(double silence_s, const config::Safety& safety,
                                     const GoalQueue& goals) {
  noteGap(silence_s, safety);
  const bool lands =
      latch_.state() == Latch::kLand || (latch_.state() == Latch::kNone && goals.landing());
  if (killed()) {
    return {Mode::kKilled, latch_.reason()};
  }
  if (!motors_on_) {
    return {Mode::kOnFloor, "no vehicle states"};
  }
  if (lands) {
    return {Mode::kLanding, latch_.reason()};
  }
  return {Mode::kHolding, "no vehicle states"};
}

}  // namespace roundabout::planner
