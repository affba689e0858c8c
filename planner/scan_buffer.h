#pragma once

#include <cstddef>
#include <vector>

#include "common/core/laser_scan.h"

namespace roundabout::planner {

/// Laser scans until a planning tick uses them. As every message, a scan takes effect at the first
/// tick with a greater time.
class ScanBuffer {
 public:
  /// Of too many the one that came first is dropped.
  void add(const core::LaserScan& scan);

  /// The newest of those from before `now`, which stays for the next call; nullptr: there is none.
  /// Valid until add().
  const core::LaserScan* newestBefore(core::Utime now);

  void clear() { scans_.clear(); }

 private:
  static constexpr std::size_t kCapacity = 64;

  std::vector<core::LaserScan> scans_;  // as they came
};

}  // namespace roundabout::planner
