#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/experiment.h"
#include "common/core/command.h"

namespace roundabout::planner {

/// What the planners of all vehicles have last commanded. A command takes effect here, as every
/// message does, at the first tick after its utime.
class CommandBook {
 public:
  explicit CommandBook(const config::Experiment& experiment);

  /// A command that was heard. `newest_frame`: utime of the newest frame; 0: none. Returns why it
  /// is refused: of an unknown vehicle, older than the one before, from the future, or too many at
  /// once; nullptr: it is not.
  const char* offer(const core::Command& command, core::Utime newest_frame);

  struct Entry {
    std::size_t vehicle;
    core::Command command;
  };
  /// Commands that take effect now: all from before `now`, in the order of time, then of vehicles.
  /// Valid until the next call.
  std::span<const Entry> apply(core::Utime now);

  /// The newest in effect; nullptr: none yet.
  const core::Command* latest(std::size_t vehicle) const;

  void clear();

 private:
  std::vector<std::string> names_;
  std::vector<core::Utime> newest_;  // heard, of each vehicle
  std::vector<Entry> pending_;
  std::vector<Entry> applied_;
  std::vector<std::optional<core::Command>> latest_;
};

}  // namespace roundabout::planner
