#include "planner/scan_buffer.h"

#include <algorithm>

namespace roundabout::planner {

void ScanBuffer::add(const core::LaserScan& scan) {
  if (scans_.size() == kCapacity) {
    scans_.erase(scans_.begin());
  }
  scans_.push_back(scan);
}

const core::LaserScan* ScanBuffer::newestBefore(core::Utime now) {
  core::Utime newest = -1;
  for (const core::LaserScan& scan : scans_) {
    newest = scan.utime < now ? std::max(newest, scan.utime) : newest;
  }
  std::erase_if(scans_, [newest](const core::LaserScan& scan) { return scan.utime < newest; });
  const auto found =
      std::find_if(scans_.begin(), scans_.end(),
                   [newest](const core::LaserScan& scan) { return scan.utime == newest; });
  return found == scans_.end() ? nullptr : &*found;
}

}  // namespace roundabout::planner
