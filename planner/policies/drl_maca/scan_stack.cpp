#include "planner/policies/drl_maca/scan_stack.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace roundabout::planner {

namespace {

constexpr int kBeams = DrlMacaTrunk::kBeams;
constexpr double kMostHoles = 0.1;  // of the beams
constexpr double kFirstAngleRad = -kDrlMacaFieldOfViewRad / 2.0;
constexpr double kAngleStepRad = kDrlMacaFieldOfViewRad / (kBeams - 1);

/// The measured beam nearest to one of the network's.
double indexOf(int beam, const core::RangeScan& scan) {
  return std::round((kFirstAngleRad + beam * kAngleStepRad - scan.first_angle_rad) /
                    scan.angle_step_rad);
}

bool covers(const core::RangeScan& scan) {
  const auto count = static_cast<double>(scan.ranges_m.size());
  const auto within = [count](double index) { return index >= 0.0 && index < count; };
  return scan.angle_step_rad != 0.0 && within(indexOf(0, scan)) &&
         within(indexOf(kBeams - 1, scan));
}

/// A beam that was not measured is no free space: a covered or dead sensor says NaN everywhere.
bool measured(const core::RangeScan& scan) {
  const auto holes = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(),
                                   [](float range_m) { return std::isnan(range_m); });
  return static_cast<double>(holes) <= kMostHoles * static_cast<double>(scan.ranges_m.size());
}

}  // namespace

bool ScanStack::push(const core::RangeScan& scan) {
  if (!covers(scan) || !measured(scan)) {
    return false;
  }
  std::rotate(scans_.begin(), scans_.begin() + 1, scans_.end());
  auto& newest = scans_.back();
  double range_m = 0.0;
  for (int beam = 0; beam < kBeams; ++beam) {
    const double here_m = scan.ranges_m[static_cast<std::size_t>(indexOf(beam, scan))];
    // In a hole what the beam before it measured stands.
    range_m = std::isnan(here_m) ? range_m : here_m;
    const bool hit = range_m < std::min(scan.max_range_m, kDrlMacaMaxRangeM);
    newest[static_cast<std::size_t>(beam)] = static_cast<float>(
        (hit ? std::max(range_m, 0.0) : kDrlMacaMaxRangeM) / kDrlMacaMaxRangeM - 0.5);
  }
  if (!std::exchange(filled_, true)) {
    scans_.fill(newest);
  }
  return true;
}

}  // namespace roundabout::planner
