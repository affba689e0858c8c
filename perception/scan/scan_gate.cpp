#include "perception/scan/scan_gate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "perception/scan/scan_points.h"

namespace roundabout::perception {

namespace {

constexpr int kBelieved = 10;

}  // namespace

const char* ScanGate::judge(const core::LaserScan& scan) {
  const std::size_t beams = scan.ranges_m.size();
  if (beams < 2) {
    return "fewer than two ranges";
  }
  if (!std::isfinite(scan.first_angle_rad) || !std::isfinite(scan.angle_step_rad) ||
      scan.angle_step_rad == 0.0 ||
      std::abs(scan.angle_step_rad) * static_cast<double>(beams - 1) >
          2.0 * std::numbers::pi + 0.1) {
    return "angles that no lidar has";
  }
  if (beams_ != 0 && beams != beams_) {
    others_in_a_row_ = beams == other_beams_ ? others_in_a_row_ + 1 : 1;
    other_beams_ = beams;
    if (others_in_a_row_ < kBelieved) {
      return "another number of ranges than before";
    }
  }
  const auto usable = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(), usableRange);
  if (2 * static_cast<std::size_t>(usable) < beams) {
    return "fewer than half of the ranges usable";
  }
  const core::FrameVerdict verdict = times_.judge(scan.utime);
  if (verdict == core::FrameVerdict::kRefused) {
    return "its time stamp is old, or corrupt";
  }
  new_epoch_ = verdict == core::FrameVerdict::kNewEpoch;
  beams_ = beams;
  others_in_a_row_ = 0;
  return nullptr;
}

}  // namespace roundabout::perception
