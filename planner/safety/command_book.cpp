#include "planner/safety/command_book.h"

#include <algorithm>
#include <tuple>

namespace roundabout::planner {

namespace {

// Of one vehicle between two ticks: planners send one a tick, and one more for each order that
// reaches them while they are killed. Without frames there are no ticks, but planners send on: then
// the newest are kept.
constexpr int kMostPending = 8;
// A planner that acts on silence is that much ahead of the frames; later it says nothing new.
constexpr core::Utime kLargestLead = core::kMicrosPerSecond;

}  // namespace

CommandBook::CommandBook(const config::Experiment& experiment)
    : newest_(experiment.vehicles.size(), 0), latest_(experiment.vehicles.size()) {
  for (const config::Vehicle& vehicle : experiment.vehicles) {
    names_.push_back(vehicle.name);
  }
}

const char* CommandBook::offer(const core::Command& command, core::Utime newest_frame) {
  const auto found = std::find(names_.begin(), names_.end(), command.vehicle);
  if (found == names_.end()) {
    return "of a vehicle that the experiment does not have";
  }
  const auto vehicle = static_cast<std::size_t>(found - names_.begin());
  if (command.utime < 0) {
    return "its time stamp is corrupt";
  }
  if (newest_frame > 0 && command.utime > newest_frame + kLargestLead) {
    return "more than a second ahead of the newest states";
  }
  if (command.utime < newest_[vehicle]) {
    return "older than the command before";
  }
  const auto of_vehicle = [&](const Entry& entry) { return entry.vehicle == vehicle; };
  if (std::count_if(pending_.begin(), pending_.end(), of_vehicle) >= kMostPending) {
    pending_.erase(std::find_if(pending_.begin(), pending_.end(), of_vehicle));
  }
  newest_[vehicle] = command.utime;
  pending_.push_back({vehicle, command});
  return nullptr;
}

std::span<const CommandBook::Entry> CommandBook::apply(core::Utime now) {
  const auto later =
      std::stable_partition(pending_.begin(), pending_.end(),
                            [&](const Entry& entry) { return entry.command.utime < now; });
  applied_.assign(pending_.begin(), later);
  pending_.erase(pending_.begin(), later);
  std::stable_sort(applied_.begin(), applied_.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.command.utime, a.vehicle) < std::tie(b.command.utime, b.vehicle);
  });
  for (const Entry& entry : applied_) {
    latest_[entry.vehicle] = entry.command;
  }
  return applied_;
}

const core::Command* CommandBook::latest(std::size_t vehicle) const {
  return latest_[vehicle] ? &*latest_[vehicle] : nullptr;
}

void CommandBook::clear() {
  std::fill(newest_.begin(), newest_.end(), 0);
  pending_.clear();
  std::fill(latest_.begin(), latest_.end(), std::nullopt);
}

}  // namespace roundabout::planner
