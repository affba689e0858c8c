#include "perception/pose_history.h"

#include <algorithm>

namespace roundabout::perception {

PoseHistory::Verdict PoseHistory::add(core::Utime utime, const PlanarPose& pose) {
  Verdict verdict = Verdict::kAccepted;
  if (!poses_.empty()) {
    const double step_s = core::toSeconds(utime - poses_.back().utime);
    const double jump_m = (pose.position_m - poses_.back().pose.position_m).norm();
    if (jump_m > limits_.top_speed_mps * step_s + limits_.jump_margin_m) {
      if (++rejects_in_a_row_ < limits_.most_rejects_in_a_row) {
        return Verdict::kRejected;
      }
      poses_.clear();
      verdict = Verdict::kJumped;
    }
  }
  rejects_in_a_row_ = 0;
  poses_.push_back({utime, pose});
  while (poses_.front().utime < utime - core::toUtime(limits_.remembered_s)) {
    poses_.pop_front();
  }
  return verdict;
}

std::optional<PlanarPose> PoseHistory::at(core::Utime utime) const {
  const auto after = std::lower_bound(
      poses_.begin(), poses_.end(), utime,
      [](const Stamped& stamped, core::Utime time) { return stamped.utime < time; });
  if (after == poses_.end()) {
    return std::nullopt;
  }
  if (after->utime == utime) {
    return after->pose;
  }
  if (after == poses_.begin()) {
    return std::nullopt;
  }
  const auto before = std::prev(after);
  const double share = static_cast<double>(utime - before->utime) /
                       static_cast<double>(after->utime - before->utime);
  return between(before->pose, after->pose, share);
}

}  // namespace roundabout::perception
