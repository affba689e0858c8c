#include "planner/goal_queue.h"

#include <spdlog/fmt/fmt.h>

#include "common/core/frame_gate.h"

namespace roundabout::planner {

const char* GoalQueue::offer(const core::Goal& goal, core::Utime newest_frame,
                             const RoomGuard& room, const Situation& situation) {
  const bool lands = goal.phase == core::GoalPhase::kLand;
  if (goal.vehicle != situation.vehicle().name) {
    return "of another vehicle";
  }
  if (goal.utime < 0 || (newest_frame > 0 && goal.utime > newest_frame + core::kFarAhead)) {
    return "its time stamp is corrupt";
  }
  if (current_ && goal.utime < current_->utime) {
    return "older than the goal before it";
  }
  if (!lands && room.mustLand(goal.position_world_m)) {
    return "outside the room";
  }
  if (!lands && config::flies(situation.vehicle()) &&
      goal.position_world_m.z() <= situation.experiment().safety.airborne_height_m) {
    return "too low to fly at";
  }
  pending_.push_back(goal);
  pending_.back().position_world_m = room.clipPosition(goal.position_world_m);
  return nullptr;
}

GoalQueue::Change GoalQueue::apply(core::Utime now, core::Utime first_frame,
                                   const Situation& situation) {
  const auto ready = [&](const core::Goal& goal) { return goal.utime < now; };
  Change change;
  for (const core::Goal& goal : pending_) {
    if (ready(goal) && (!current_ || goal.utime >= current_->utime)) {
      apply(goal, first_frame, situation, change);
    }
  }
  std::erase_if(pending_, ready);
  return change;
}

void GoalQueue::apply(const core::Goal& goal, core::Utime first_frame, const Situation& situation,
                      Change& change) {
  const bool is_new =
      !current_ || current_->goal_id != goal.goal_id || current_->phase != goal.phase;
  if (is_new && goal.phase == core::GoalPhase::kTakeOff && situation.own().seen()) {
    const double away_m = situation.awayFrom(goal);
    if (away_m > kTakeOffReachM) {
      ++change.refused;
      refusal_ = fmt::format("a take-off goal {:.1f} m away was refused", away_m);
      return;
    }
  }
  refusal_.clear();
  change.from_past = change.from_past || (!current_ && goal.utime < first_frame);
  change.is_new = change.is_new || is_new;
  current_ = goal;
}

void GoalQueue::clear() {
  pending_.clear();
  current_.reset();
  refusal_.clear();
}

}  // namespace roundabout::planner
