#pragma once

#include <deque>
#include <optional>

#include "common/core/time.h"
#include "perception/scan/scan_points.h"

namespace roundabout::perception {

/// Where the own vehicle was lately.
class PoseHistory {
 public:
  struct Limits {
    double top_speed_mps = 2.0;
    double jump_margin_m = 0.15;
    int most_rejects_in_a_row = 10;
    double remembered_s = 2.0;
  };
  enum class Verdict {
    kAccepted,
    kRejected,  ///< farther away than the vehicle can be
    kJumped     ///< for so long that it must be true: what was before holds no more
  };

  explicit PoseHistory(const Limits& limits) : limits_(limits) {}

  /// Precondition: later than the one before.
  Verdict add(core::Utime utime, const PlanarPose& pose);
  /// Between the two poses around a time; nothing if it is newer than all or older than all.
  std::optional<PlanarPose> at(core::Utime utime) const;
  core::Utime newest() const { return poses_.empty() ? 0 : poses_.back().utime; }
  core::Utime oldest() const { return poses_.empty() ? 0 : poses_.front().utime; }
  bool empty() const { return poses_.empty(); }
  void clear() { poses_.clear(); }

 private:
  struct Stamped {
    core::Utime utime;
    PlanarPose pose;
  };

  Limits limits_;
  std::deque<Stamped> poses_;
  int rejects_in_a_row_ = 0;
};

}  // namespace roundabout::perception
