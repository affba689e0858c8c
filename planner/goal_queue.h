#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/command.h"
#include "planner/safety/room_guard.h"
#include "planner/situation.h"

namespace roundabout::planner {

/// The goal that is flown, and those whose time has not come.
class GoalQueue {
 public:
  /// A goal that takes effect at the first tick after its utime; one a little outside the room is
  /// moved to its edge. `newest_frame`: utime of the newest frame; 0: none. Returns why it is
  /// refused; nullptr: it is not.
  const char* offer(const core::Goal& goal, core::Utime newest_frame, const RoomGuard& room,
                    const Situation& situation);

  /// What became of the goals whose time has come.
  struct Change {
    bool is_new = false;     ///< another goal, or phase, than before
    bool from_past = false;  ///< the first goal, given before `first_frame`
    int refused = 0;         ///< take-offs somewhere else than where the vehicle is
  };
  Change apply(core::Utime now, core::Utime first_frame, const Situation& situation);

  const std::optional<core::Goal>& current() const { return current_; }
  bool landing() const { return current_ && current_->phase == core::GoalPhase::kLand; }
  /// Why the last goal was not flown; empty: it was.
  const std::string& refusal() const { return refusal_; }
  void clear();

 private:
  void apply(const core::Goal& goal, core::Utime first_frame, const Situation& situation,
             Change& change);

  std::vector<core::Goal> pending_;
  std::optional<core::Goal> current_;
  std::string refusal_;
};

/// m. A take-off is straight up, give or take the drift since the fleet looked.
inline constexpr double kTakeOffReachM = 0.5;

}  // namespace roundabout::planner
